#include "palpable/live/render/color_map.h"

#include "palpable/live/render/glsl_as_cpp.h"

namespace palpable {
namespace glsl {
namespace {
#include "palpable/live/render/shaders/color_map.glsl"
}  // namespace
}  // namespace glsl

namespace {

Rgb rgb_of(glsl::vec3 c) {
  const auto byte = [](float value) {
    return static_cast<std::uint8_t>(std::lround(255.0f * value));
  };
  return {byte(c.x), byte(c.y), byte(c.z)};
}

glsl::vec3 unit_color(Rgb color) {
  const auto unit = [](std::uint8_t byte) { return static_cast<float>(byte) / 255.0f; };
  return {unit(color.r), unit(color.g), unit(color.b)};
}

}  // namespace

Rgb color_of_share(float share, ColorScale scale) {
  return rgb_of(glsl::color_map(share, static_cast<int>(scale)));
}

Rgb color_of_share(float share, Rgb material, float opaque, ColorScale scale) {
  return rgb_of(glsl::painted(unit_color(material), share, opaque, static_cast<int>(scale)));
}

Rgb two_sided_color_of_share(float share) { return rgb_of(glsl::two_sided_color_map(share)); }

Rgb two_sided_color_of_share(float share, Rgb material, float opaque) {
  return rgb_of(glsl::two_sided_painted(unit_color(material), share, opaque));
}

}  // namespace palpable
