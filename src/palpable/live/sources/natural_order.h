/// @file
/// Names sorted by the numbers in them: frame_2 before frame_10.
#pragma once

#include <string_view>

namespace palpable {

/// Whether `a` comes before `b`: digits compare as numbers of any length, all else byte by byte;
/// names that are then equal (07 and 7) compare as text. A strict weak order.
[[nodiscard]] bool natural_less(std::string_view a, std::string_view b);

}  // namespace palpable
