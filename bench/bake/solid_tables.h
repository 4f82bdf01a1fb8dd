/// @file
/// The results of `bench solid` as a section of docs/results.md (tools/write_results.py).
#pragma once

#include "palpable/common/base/json.h"

#include <string>

namespace palpable::app {

/// The sentence above the tables. @param tolerance residual at which both programs stop
[[nodiscard]] std::string solid_section_text(const Json& result, const std::string& law, int levels,
                                             double tolerance);

/// Tables of the paths, one per row, of the distribution of our time, and of the
/// machine's lower bound.
[[nodiscard]] Json solid_section_tables(const Json& result);

}  // namespace palpable::app
