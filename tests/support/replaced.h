/// @file
/// Texts with one thing wrong, for the tests of readers.
#pragma once

#include "tests/support/test.h"

#include <string>

namespace palpable::test {

/// `text` with the first `what`, which must be there and something else, made `with`.
inline std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  REQUIRE(at != std::string::npos);
  REQUIRE(what != with);
  return text.replace(at, what.size(), with);
}

}  // namespace palpable::test
