/// @file
/// Names in the order in which a person counts: frame_2 before frame_10.
#pragma once

#include <string_view>

namespace palpable {

/// Strict weak order: runs of digits compare as numbers of any length, the rest byte by byte; names
/// that are equal so far (07 and 7) compare as text.
[[nodiscard]] bool natural_less(std::string_view a, std::string_view b);

}  // namespace palpable
