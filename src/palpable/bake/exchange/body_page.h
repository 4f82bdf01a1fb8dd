/// @file
/// Reports on a body file: its errors, its size and times, and pictures of its modes. As an HTML
/// page for people and as a CSV table for programs.
#pragma once

#include "palpable/common/reduced/reduced_body.h"
#include "palpable/common/response/stated_error.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// Facts for the report that are not in the body: its file, and measured times.
struct BodyPageFacts {
  std::string file;  ///< name, for people
  std::uintmax_t file_bytes = 0;
  /// Microseconds of one evaluation; medians over sites and levels.
  double displacement_us = 0;
  double stress_us = 0;
  double all_us = 0;  ///< displacement, stress, and von Mises stress computed from it
  int repeats = 0;    ///< evaluations behind each median
  std::string processor, date, program;
  std::string touch = {};  ///< touch_text() of the file's tables
  std::vector<HeldOutTouch> held_out = {};
};

/// The report as one HTML file that loads nothing.
/// @param csv_name  name of the table's file, to which the page links
[[nodiscard]] std::string body_page(const ReducedBody& body, const BodyPageFacts& facts,
                                    const std::string& csv_name);

/// The first line of the table below.
constexpr std::string_view kBodyTableHeader = "quantity,field,modes,site,level,further,value,unit";

/// The same numbers as CSV, one a line.
[[nodiscard]] std::string body_table(const ReducedBody& body, const BodyPageFacts& facts);

}  // namespace palpable
