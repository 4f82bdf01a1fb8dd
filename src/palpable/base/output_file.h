/// @file
/// Files that are written now, or will be later.
#pragma once

#include <filesystem>
#include <string_view>

namespace palpable {

/// Tries to open a file for writing, before work of minutes or hours that would be lost if it could
/// not be written. What stands in it stays; a file that was not there is not there afterwards.
/// @throws Error "FILE: cannot be written"
void expect_writable(const std::filesystem::path& file);

/// Before the work, not after it. @throws Error when the folder of `output` does not exist
void expect_folder_of(const std::filesystem::path& output);

/// Replaces a file by a text. @throws Error with the reason when that fails
void write_text_file(const std::filesystem::path& file, std::string_view text);

}  // namespace palpable
