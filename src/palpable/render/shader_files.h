/// @file
/// The shaders of this module, compiled into the program from render/shaders by
/// cmake/EmbedFiles.cmake.
#pragma once

#include "palpable/render/gl_objects.h"

#include <span>

namespace palpable {

[[nodiscard]] std::span<const ShaderFile> render_shader_files();

}  // namespace palpable
