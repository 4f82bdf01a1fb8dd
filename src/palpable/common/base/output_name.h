/// @file
/// Checks that the name of an output says what is written: a VTK grid that is called x.stl misleads
/// whoever opens it.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

namespace palpable {

/// To be called before the work. Endings are compared as they are, small letters by small letters,
/// because programs that open the file compare them so.
/// @param endings  with their dots, at least one: {".yml", ".yaml"}
/// @param what     what is written, with its article: "a VTK grid"
/// @throws Error that names the endings and a name to use, unless the name ends in one of them
void require_ending(const std::filesystem::path& output,
                    const std::vector<std::string_view>& endings, std::string_view what);

/// The same for a folder, which may have any name but that of a file: "x.npy", "film.mp4".
/// @throws Error
void require_folder_name(const std::filesystem::path& output);

}  // namespace palpable
