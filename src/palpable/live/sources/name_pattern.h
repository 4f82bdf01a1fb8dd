/// @file
/// Names with * and ?, as shells have them.
#pragma once

#include <string_view>

namespace palpable {

/// Whether a name is what a pattern says: '*' stands for any characters, '?' for one. Costs at most
/// the product of the two lengths.
[[nodiscard]] bool matches_pattern(std::string_view name, std::string_view pattern);

}  // namespace palpable
