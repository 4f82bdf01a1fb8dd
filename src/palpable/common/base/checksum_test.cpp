#include "palpable/common/base/checksum.h"

#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <set>
#include <string>
#include <utility>

namespace palpable {
namespace {

// The values of the function's authors (Fowler, Noll, Vo), list of 64-bit FNV-1a test vectors.
TEST_CASE("FNV-1a gives its authors' values, in one piece or in two", "[base]") {
  CHECK(fnv1a("") == 0xcbf29ce484222325u);
  CHECK(fnv1a("a") == 0xaf63dc4c8601ec8cu);
  CHECK(fnv1a("foobar") == 0x85944171f73967e8u);
  CHECK(fnv1a("bar", fnv1a("foo")) == fnv1a("foobar"));
}

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

TEST_CASE("a file's checksum changes with any of its bytes and with its length", "[base][hash]") {
  const test::ScratchFolder folder("file_checksum");
  const auto of = [&](const std::string& bytes) {
    test::write_bytes(folder / "a", bytes);
    return file_checksum(folder / "a").value();
  };
  std::string bytes(3'000'001, 'x');  // several pieces and a rest
  const std::uint64_t whole = of(bytes);
  CHECK(of(bytes) == whole);
  CHECK(of(bytes.substr(1)) != whole);
  for (const std::size_t at : {std::size_t{0}, std::size_t{1} << 20, bytes.size() - 1}) {
    std::string changed = bytes;
    changed[at] = 'y';
    CHECK(of(changed) != whole);
  }
  CHECK(of("") != whole);
}

TEST_CASE("a checksum of something that is not a file is refused", "[base][hash][errors]") {
  const test::ScratchFolder folder("no_checksum");
  CHECK(file_checksum(folder.path()).problem().message == "is a folder, not a file");
  CHECK(file_checksum(folder / "none").problem().message == "no such file");
}

}  // namespace

}  // namespace palpable
