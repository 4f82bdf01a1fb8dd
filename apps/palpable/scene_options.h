/// @file
/// Scene files with options of `live`: a run in one file.
#pragma once

#include "apps/common/command_line.h"
#include "apps/palpable/live_options.h"

#include <filesystem>
#include <string>
#include <vector>

namespace palpable::app {

/// The options at the top of a scene file. Relative paths in them are from the file's folder.
/// @throws Error naming file, line and key
[[nodiscard]] std::vector<Command::FileOption> options_of_scene(const std::filesystem::path& scene);

/// A scene file for a call of `live`: its options and bodies, with full paths.
/// @param given  the options of the call
/// @throws Error when a scene file of the call cannot be read
[[nodiscard]] std::string scene_file_text(const LiveOptions& options,
                                          const std::vector<Command::GivenOption>& given);

}  // namespace palpable::app
