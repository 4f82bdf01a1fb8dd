/// @file
/// Files that will be written later.
#pragma once

#include <filesystem>

namespace palpable {

/// Tries to open a file for writing, before work of minutes or hours that would be lost if it could
/// not be written. What stands in it stays; a file that was not there is not there afterwards.
/// @throws Error "FILE: cannot be written"
void expect_writable(const std::filesystem::path& file);

}  // namespace palpable
