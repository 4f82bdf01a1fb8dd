/// @file
/// What benches of the loop share: the usual body files, and films of them that are kept.
#pragma once

#include "palpable/common/base/progress.h"

#include <filesystem>
#include <initializer_list>
#include <string>

namespace palpable::app {

/// The first of these files that is there; empty: none is.
[[nodiscard]] std::filesystem::path first_there(std::initializer_list<const char*> files);

/// The frames of a sequence of the synthetic desk with a body, filmed unless `clip` holds them.
/// @param clip  folder; folders above it are made. @throws Error when it cannot be written
[[nodiscard]] std::filesystem::path kept_frames(const std::filesystem::path& clip,
                                                const std::filesystem::path& body_file,
                                                const std::string& sequence, int frames,
                                                const Progress& progress);

}  // namespace palpable::app
