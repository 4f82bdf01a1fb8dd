#include "palpable/render/color_map.h"

#include "palpable/render/glsl_as_cpp.h"

namespace palpable {
namespace glsl {
namespace {
#include "palpable/render/shaders/color_map.glsl"
}  // namespace
}  // namespace glsl

Rgb color_of_share(float share) {
  const glsl::vec3 c = glsl::color_map(share);
  const auto byte = [](float value) {
    return static_cast<std::uint8_t>(std::lround(255.0f * value));
  };
  return {byte(c.x), byte(c.y), byte(c.z)};
}

}  // namespace palpable
