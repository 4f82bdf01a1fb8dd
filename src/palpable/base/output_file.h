/// @file
/// Checks files that will be written later.
#pragma once

#include <filesystem>

namespace palpable {

/// Tries to open a file for writing, before work of minutes or hours that would be lost if it could
/// not be written. An existing file keeps its content; a file that did not exist is removed again.
/// @throws Error "FILE: cannot be written"
void expect_writable(const std::filesystem::path& file);

}  // namespace palpable
