/// @file
/// Folders with one file per frame: FOLDER/000000.png, FOLDER/000001.png and so on.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace palpable {

/// The file name of a frame, such as "000007.png". @param ending  with its dot
[[nodiscard]] std::string frame_name(int frame, std::string_view ending);

/// The largest frame number among the folder's files plus one; 0 if there is no such folder.
[[nodiscard]] int frames_in(const std::filesystem::path& folder);

/// Checks that the files of a folder are named as frame_name() names them; otherwise all its frames
/// would silently count as missing. An empty folder passes: a run that found nothing writes one.
/// @throws Error naming the folder and one of its files when no file has such a name
void expect_frames_in(const std::filesystem::path& folder, std::string_view ending);

}  // namespace palpable
