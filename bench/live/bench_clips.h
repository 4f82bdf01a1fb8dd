/// @file
/// Functions shared by benchmarks of the loop: default body files and synthetic
/// clips, which are kept.
#pragma once

#include "palpable/common/base/progress.h"

#include <filesystem>
#include <initializer_list>
#include <string>

namespace palpable::app {

/// The first of these files that exists; empty if none does.
[[nodiscard]] std::filesystem::path first_there(std::initializer_list<const char*> files);

/// The frames/ of a synthetic sequence with a body; rendered unless `clip` already has it.
/// @param clip  folder; its parents are made. @throws Error when it cannot be written
[[nodiscard]] std::filesystem::path kept_frames(const std::filesystem::path& clip,
                                                const std::filesystem::path& body_file,
                                                const std::string& sequence, int frames,
                                                const Progress& progress);

}  // namespace palpable::app
