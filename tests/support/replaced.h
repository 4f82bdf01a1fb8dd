/// @file
/// Texts with a single change, for tests of readers.
#pragma once

#include "tests/support/test.h"

#include <string>

namespace palpable::test {

/// `text` with the first occurrence of `what` replaced by `with`. `what` must occur and
/// differ from `with`.
inline std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  REQUIRE(at != std::string::npos);
  REQUIRE(what != with);
  return text.replace(at, what.size(), with);
}

/// The same with every occurrence replaced.
inline std::string replaced_everywhere(std::string text, const std::string& what,
                                       const std::string& with) {
  REQUIRE(text.find(what) != std::string::npos);
  for (std::size_t at = text.find(what); at != std::string::npos;
       at = text.find(what, at + with.size())) {
    text.replace(at, what.size(), with);
  }
  return text;
}

/// `text` repeated `count` times.
inline std::string repeated(const std::string& text, int count) {
  std::string all;
  for (int i = 0; i < count; ++i) all += text;
  return all;
}

}  // namespace palpable::test
