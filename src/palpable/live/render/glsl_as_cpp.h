/// @file
/// The part of GLSL that compiles render/shaders/*.glsl as C++. Include this header, open
/// `namespace palpable::glsl {`, include the .glsl, and close the namespace.
#pragma once

#include <algorithm>
#include <cmath>

namespace palpable::glsl {

struct vec3 {
  float x = 0, y = 0, z = 0;
  constexpr explicit vec3(float all) : x(all), y(all), z(all) {}
  constexpr vec3(float x_, float y_, float z_) : x(x_), y(y_), z(z_) {}
};
constexpr vec3 operator+(vec3 a, vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr vec3 operator*(float s, vec3 a) { return {s * a.x, s * a.y, s * a.z}; }

inline float abs(float x) { return std::fabs(x); }
inline float max(float a, float b) { return std::max(a, b); }
inline float clamp(float x, float low, float high) { return std::min(std::max(x, low), high); }
inline vec3 clamp(vec3 x, float low, float high) {
  return {clamp(x.x, low, high), clamp(x.y, low, high), clamp(x.z, low, high)};
}
inline float smoothstep(float a, float b, float x) {
  const float t = clamp((x - a) / (b - a), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

}  // namespace palpable::glsl
