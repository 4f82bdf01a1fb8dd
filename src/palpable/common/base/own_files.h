/// @file
/// Finds and removes the files that a program writes into a folder, by their names; what somebody
/// else put beside them stays.
#pragma once

#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace palpable {

/// Relative paths of files with '/' between their parts. In a part
///
///     #   stands for a number of six digits or more: "depth/#.png" is depth/000017.png
///     *   alone, is any one folder: "meshes/*/rest.ply"
///
/// Everything else is literal.
using OwnNames = std::span<const std::string_view>;

/// The files of these names in the folder, in the order of the patterns; links to files count,
/// links to folders are not followed: what they hold is somebody's. Empty where the folder does not
/// exist.
[[nodiscard]] std::vector<std::filesystem::path> own_files(const std::filesystem::path& folder,
                                                           OwnNames names);

/// Removes them, those of the last pattern first, and then the folders in the patterns that have
/// become empty; `folder` itself stays.
/// @throws Error "FILE: cannot be removed: REASON"
void remove_own_files(const std::filesystem::path& folder, OwnNames names);

}  // namespace palpable
