/// @file
/// The shaders' occlusion_bias(), as C++ (shaders/occlusion_bias.glsl says what it is).
#pragma once

#include "palpable/render/glsl_as_cpp.h"

namespace palpable::glsl {
namespace {
#include "palpable/render/shaders/occlusion_bias.glsl"
}  // namespace
}  // namespace palpable::glsl
