/// @file
/// A page, and the table of its numbers beside it.
#pragma once

#include "palpable/base/error.h"

#include <fmt/format.h>

#include <filesystem>

namespace palpable::app {

/// "report.html" has "report.csv". @throws Error if the page is called .csv itself
[[nodiscard]] inline std::filesystem::path table_beside(const std::filesystem::path& page) {
  std::filesystem::path table = page;
  table.replace_extension(".csv");
  if (table == page) {
    throw Error(fmt::format("{}: is where the table goes; call the page {}.html", page.string(),
                            page.stem().string()));
  }
  return table;
}

}  // namespace palpable::app
