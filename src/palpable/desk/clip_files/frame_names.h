/// @file
/// Folders with a file per frame: FOLDER/000000.png, FOLDER/000001.png and so on.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace palpable {

/// "000007.png". @param ending  with its dot
[[nodiscard]] std::string frame_name(int frame, std::string_view ending);

/// The largest number of the folder's files, plus one; 0 without the folder.
[[nodiscard]] int frames_in(const std::filesystem::path& folder);

/// Refuses a folder whose files have other names: all its frames would silently count as missing.
/// An empty folder is that of a run that found nothing.
/// @throws Error naming the folder and one of its files
void expect_frames_in(const std::filesystem::path& folder, std::string_view ending);

}  // namespace palpable
