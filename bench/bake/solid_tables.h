/// @file
/// What `bench solid` found, as a section of docs/results.md (tools/write_results.py).
#pragma once

#include "palpable/common/base/json.h"

#include <string>

namespace palpable::app {

/// The sentence above the tables. @param tolerance  residual at which both programs stop
[[nodiscard]] std::string solid_section_text(const Json& result, const std::string& law, int levels,
                                             double tolerance);

/// Paths, one a row; where our time goes; what this machine would take at least.
[[nodiscard]] Json solid_section_tables(const Json& result);

}  // namespace palpable::app
