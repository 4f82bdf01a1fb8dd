/// @file
/// Matching of names with * and ?, as in a shell.
#pragma once

#include <string_view>

namespace palpable {

/// Whether a name matches a pattern: '*' stands for any number of characters, '?' for one. The time
/// is at most proportional to the product of the two lengths.
[[nodiscard]] bool matches_pattern(std::string_view name, std::string_view pattern);

}  // namespace palpable
