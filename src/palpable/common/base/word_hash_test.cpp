#include "palpable/common/base/word_hash.h"

#include "tests/support/test.h"

#include <set>
#include <string>
#include <utility>

namespace palpable {
namespace {

std::uint64_t hash_of(const std::string& bytes) {
  WordHash hash;
  hash.add(bytes.data(), bytes.size());
  return hash.value();
}

TEST_CASE("every bit of every byte and every length changes the checksum", "[base][hash]") {
  for (std::size_t size = 0; size <= 17; ++size) {
    std::set<std::uint64_t> seen{hash_of(std::string(size, 'x'))};
    for (std::size_t bit = 0; bit < 8 * size; ++bit) {
      std::string changed(size, 'x');
      changed[bit / 8] = static_cast<char>(changed[bit / 8] ^ (1 << bit % 8));
      seen.insert(hash_of(changed));
    }
    CHECK(seen.size() == 8 * size + 1);
  }
  CHECK(hash_of("") != hash_of(std::string(1, '\0')));
  CHECK(hash_of(std::string(7, '\0')) != hash_of(std::string(8, '\0')));
}

TEST_CASE("changed signs of two numbers do not cancel, nor do two that are swapped",
          "[base][hash]") {
  const auto of = [](double a, double b) {
    WordHash hash;
    hash.add(a);
    hash.add(b);
    return hash.value();
  };
  CHECK(of(1, 2) != of(-1, -2));
  CHECK(of(1, 2) != of(2, 1));
  CHECK(of(0, 1) != of(-0.0, 1));
  CHECK(of(1, 2) == of(1, 2));
}

TEST_CASE("pieces enter with their sizes", "[base][hash]") {
  WordHash one, other;
  one.add("ab", 2);
  one.add("c", 1);
  other.add("a", 1);
  other.add("bc", 2);
  CHECK(one.value() != other.value());
}

}  // namespace
}  // namespace palpable
