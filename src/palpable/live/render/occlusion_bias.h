/// @file
/// The shaders' occlusion_bias() as a C++ function (see shaders/occlusion_bias.glsl).
#pragma once

#include "palpable/live/render/glsl_as_cpp.h"

namespace palpable::glsl {
namespace {
#include "palpable/live/render/shaders/occlusion_bias.glsl"
}  // namespace
}  // namespace palpable::glsl
