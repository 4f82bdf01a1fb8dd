/// @file
/// Prints results of a verification test as lines that tools/write_verification.py collects.
#pragma once

#include <fmt/format.h>

#include <initializer_list>
#include <iostream>
#include <string>
#include <string_view>
#include <utility>

namespace palpable::test {

/// Prints one row of a table: "VERIFICATION<tab>table<tab>column=value<tab>...". The first row of a
/// table names its columns. Values are the text in the document.
inline void record(std::string_view table,
                   std::initializer_list<std::pair<std::string_view, std::string>> row) {
  std::string line = fmt::format("VERIFICATION\t{}", table);
  for (const auto& [column, value] : row) line += fmt::format("\t{}={}", column, value);
  std::cout << line << std::endl;
}

}  // namespace palpable::test
