/// @file
/// The shaders of render/shaders, which cmake/EmbedFiles.cmake compiles into the program.
#pragma once

#include "palpable/live/render/gl_objects.h"

#include <span>

namespace palpable {

/// All of them; names without the folder.
[[nodiscard]] std::span<const ShaderFile> render_shader_files();

}  // namespace palpable
