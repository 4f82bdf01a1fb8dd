/// @file
/// Pages and the tables beside them.
#pragma once

#include <filesystem>
#include <string_view>

namespace palpable::app {

/// "report.html" has "report.csv". @throws Error if the page is called .csv itself
[[nodiscard]] std::filesystem::path table_beside(const std::filesystem::path& page);

/// @throws Error if the file cannot be written
void write_text_file(const std::filesystem::path& path, std::string_view text);

}  // namespace palpable::app
