/// @file
/// A guess for a mistyped word: "did you mean ...?"
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// The candidate that needs the fewest edits (insert, drop, change or swap of letters) to become
/// `word`. Empty if each of them needs more edits than a guess allows: 1 for a word of 2 to 4
/// letters, 2 for one of 5 to 7, and so on, about a third of the letters.
[[nodiscard]] std::string nearest_word(std::string_view word,
                                       const std::vector<std::string>& candidates);

}  // namespace palpable
