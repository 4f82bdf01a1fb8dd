/// @file
/// std::from_chars for doubles, which libc++ does not have until version 20.
#pragma once

#include <charconv>

namespace palpable {

/// As std::from_chars: no white space and no plus sign before the number, a point whatever the
/// locale, rounded to the nearest double.
[[nodiscard]] std::from_chars_result double_from_chars(const char* first, const char* last,
                                                       double& value);

}  // namespace palpable
