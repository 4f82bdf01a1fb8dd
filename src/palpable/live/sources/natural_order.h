/// @file
/// Sorts names by the numbers in them: frame_2 before frame_10.
#pragma once

#include <string_view>

namespace palpable {

/// Whether `a` comes before `b`: digits compare as numbers of any length, everything else byte by
/// byte; names that are equal in this sense (07 and 7) compare as text. A strict weak order.
[[nodiscard]] bool natural_less(std::string_view a, std::string_view b);

}  // namespace palpable
