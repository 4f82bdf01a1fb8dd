#include "palpable/live/sources/name_pattern.h"

#include "tests/support/test.h"

#include <string>

namespace palpable {
namespace {

// The definition of the two signs as a recursion; exponential time with many stars.
bool obviously(std::string_view name, std::string_view pattern) {
  if (pattern.empty()) return name.empty();
  if (pattern.front() == '*') {
    return obviously(name, pattern.substr(1)) ||
           (!name.empty() && obviously(name.substr(1), pattern));
  }
  return !name.empty() && (pattern.front() == '?' || pattern.front() == name.front()) &&
         obviously(name.substr(1), pattern.substr(1));
}

TEST_CASE("a star stands for any characters, a question mark for one", "[sources][pattern]") {
  CHECK(matches_pattern("left_01.png", "left*.png"));
  CHECK(matches_pattern("left.png", "left*.png"));
  CHECK(matches_pattern("a1.png", "a?.png"));
  CHECK_FALSE(matches_pattern("a.png", "a?.png"));
  CHECK_FALSE(matches_pattern("left.png.txt", "left*.png"));
  CHECK(matches_pattern("", "**"));
  CHECK_FALSE(matches_pattern("", "?"));
  CHECK_FALSE(matches_pattern("a", ""));
}

TEST_CASE("short names match short patterns as the slow definition says", "[sources][pattern]") {
  int agreed = 0;
  for (unsigned seed = 0; seed < 20'000; ++seed) {
    auto random = test::random_case(seed);
    const auto word = [&](std::string_view letters, unsigned most) {
      std::string text(random() % (most + 1), ' ');
      for (char& c : text) c = letters[random() % letters.size()];
      return text;
    };
    const std::string name = word("ab", 7), pattern = word("ab*?", 6);
    if (matches_pattern(name, pattern) == obviously(name, pattern)) {
      ++agreed;
    } else {
      FAIL_CHECK("seed " << seed << ": '" << name << "' and '" << pattern << "'");
    }
  }
  CHECK(agreed == 20'000);
}

TEST_CASE("many stars take no time without end", "[sources][pattern]") {
  const std::string name(250, 'a');
  std::string pattern;
  for (int i = 0; i < 60; ++i) pattern += "*a";
  CHECK(matches_pattern(name, pattern + "*"));
  CHECK_FALSE(matches_pattern(name, pattern + "*b.png"));  // 250 over 60 combinations
}

}  // namespace
}  // namespace palpable
