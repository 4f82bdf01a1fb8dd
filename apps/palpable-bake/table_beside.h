/// @file
/// A page, and the table of its numbers beside it.
#pragma once

#include <filesystem>

namespace palpable::app {

/// "report.html" has "report.csv". Nobody names that file, so one that is there is replaced only if
/// it is such a table.
/// @throws Error if the page is called .csv itself, and for a .csv of somebody's
[[nodiscard]] std::filesystem::path table_beside(const std::filesystem::path& page);

}  // namespace palpable::app
