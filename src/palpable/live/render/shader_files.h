/// @file
/// The shaders of render/shaders, which cmake/EmbedFiles.cmake compiles into the program.
#pragma once

#include "palpable/live/render/gl_objects.h"

#include <span>

namespace palpable {

/// All shader files, named without the folder.
[[nodiscard]] std::span<const ShaderFile> render_shader_files();

}  // namespace palpable
