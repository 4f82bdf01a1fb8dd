#include "palpable/common/base/nearest_word.h"

#include "tests/support/test.h"

namespace palpable {
namespace {

const std::vector<std::string> kWords{"young", "poisson", "law", "levels"};

TEST_CASE("a mistyped word finds the one that was meant", "[base]") {
  CHECK(nearest_word("yuong", kWords) == "young");
  CHECK(nearest_word("poison", kWords) == "poisson");
  CHECK(nearest_word("level", kWords) == "levels");
  CHECK(nearest_word("laws", kWords) == "law");
  CHECK(nearest_word("young", kWords) == "young");
}

TEST_CASE("a word unlike any other gets no guess", "[base]") {
  CHECK(nearest_word("density", kWords).empty());
  CHECK(nearest_word("nothing", {"rolling", "pressing"}).empty());  // 3 of 7 letters differ
  CHECK(nearest_word("xaw", kWords) == "law");
  CHECK(nearest_word("xay", kWords).empty());
  CHECK(nearest_word("young", {}).empty());
  CHECK(nearest_word("", kWords).empty());
}

}  // namespace
}  // namespace palpable
