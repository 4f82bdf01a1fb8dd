#include "palpable/live/sources/name_pattern.h"

#include <cstddef>

namespace palpable {

bool matches_pattern(std::string_view name, std::string_view pattern) {
  // Only the last star needs to be extended after a mismatch: the part before it is matched as
  // early as possible, which leaves most characters for the rest.
  std::size_t n = 0, p = 0;
  std::size_t star = std::string_view::npos, behind_star = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      behind_star = n;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
      ++p;
      ++n;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      n = ++behind_star;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == std::string_view::npos;
}

}  // namespace palpable
