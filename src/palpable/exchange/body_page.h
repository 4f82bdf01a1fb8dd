/// @file
/// What a body file gives up, what it costs and what its modes look like: as a page for people and
/// as a table for programs.
#pragma once

#include "palpable/reduced/reduced_body.h"

#include <cstdint>
#include <string>

namespace palpable {

/// What is not in the body but was measured, or is known of its file.
struct BodyPageFacts {
  std::string file;  ///< name, for people
  std::uintmax_t file_bytes = 0;
  /// Microseconds of one evaluation, medians over sites and levels.
  double displacement_us = 0;
  double stress_us = 0;
  double all_us = 0;  ///< displacement, stress and from it von Mises stress
  int repeats = 0;    ///< evaluations that each median is of
  std::string processor, date, program;
};

/// One HTML file that loads nothing.
/// @param csv_name  of the table beside it
[[nodiscard]] std::string body_page(const ReducedBody& body, const BodyPageFacts& facts,
                                    const std::string& csv_name);

/// The same numbers, one a line: quantity,field,modes,site,level,further,value,unit
[[nodiscard]] std::string body_table(const ReducedBody& body, const BodyPageFacts& facts);

}  // namespace palpable
