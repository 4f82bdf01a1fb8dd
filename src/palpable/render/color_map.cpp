#include "palpable/render/color_map.h"

#include "palpable/render/glsl_as_cpp.h"

namespace palpable {
namespace glsl {
namespace {
#include "palpable/render/shaders/color_map.glsl"
}  // namespace
}  // namespace glsl

namespace {

Rgb bytes_of(glsl::vec3 c) {
  const auto byte = [](float value) {
    return static_cast<std::uint8_t>(std::lround(255.0f * value));
  };
  return {byte(c.x), byte(c.y), byte(c.z)};
}

}  // namespace

Rgb color_of_share(float share) { return bytes_of(glsl::color_map(share)); }

Rgb color_of_share(float share, Rgb material, float opaque) {
  const auto unit = [](std::uint8_t byte) { return static_cast<float>(byte) / 255.0f; };
  const glsl::vec3 below(unit(material.r), unit(material.g), unit(material.b));
  return bytes_of(glsl::painted(below, share, opaque));
}

}  // namespace palpable
