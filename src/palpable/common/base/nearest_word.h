/// @file
/// A guess for a mistyped word: "did you mean ...?"
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// The candidate that needs the fewest edits (insert, drop, change or swap of letters) to become
/// `word`; empty if all need more edits than a third of the letters, rounded to the nearest number:
/// 1 for words of 2 to 4 letters, 2 for those of 5 to 7.
[[nodiscard]] std::string nearest_word(std::string_view word,
                                       const std::vector<std::string>& candidates);

}  // namespace palpable
