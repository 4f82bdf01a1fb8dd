/// @file
/// Writes files, and checks that files can be written later.
#pragma once

#include <filesystem>
#include <string_view>

namespace palpable {

/// Tries to open a file for writing, before work of minutes or hours that would be lost if it could
/// not be written. An existing file keeps its content; a file that did not exist is removed again.
/// @throws Error "FILE: cannot be written"
void expect_writable(const std::filesystem::path& file);

/// For a check before the work. @throws Error when the folder of `output` does not exist
void expect_folder_of(const std::filesystem::path& output);

/// Makes a folder and those above it where they are missing.
/// @throws Error "FOLDER: cannot be made", with the reason
void make_folder(const std::filesystem::path& folder);

/// Replaces a file by a text. @throws Error with the reason when that fails
void write_text_file(const std::filesystem::path& file, std::string_view text);

}  // namespace palpable
