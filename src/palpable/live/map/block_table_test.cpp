#include "palpable/live/map/block_table.h"

#include "tests/support/test.h"

#include <random>
#include <unordered_map>

namespace palpable {
namespace {

TEST_CASE("a table finds what was put in and not taken out", "[map][block_table]") {
  // The table is full most of the time, so that keys collide and removals leave gaps.
  constexpr int kCapacity = 100;
  BlockTable table(kCapacity);
  std::unordered_map<std::uint64_t, int> expected;
  std::mt19937 random(1);
  const auto any_key = [&] {
    const auto part = [&] { return static_cast<int>(random() % 7) - 3; };
    const int x = part(), y = part(), z = part();
    return BlockTable::key_of(x, y, z);
  };
  int refused = 0;
  for (int step = 0; step < 20000; ++step) {
    const std::uint64_t key = any_key();
    if (const auto at = expected.find(key); at != expected.end()) {
      REQUIRE(table.find(key) == at->second);
      table.erase(at->second);
      expected.erase(at);
    } else {
      REQUIRE(table.find(key) == BlockTable::kNone);
      const int slot = table.insert(key);
      if (slot == BlockTable::kNone) {
        REQUIRE(expected.size() == kCapacity);
        ++refused;
      } else {
        REQUIRE(table.key(slot) == key);
        expected.emplace(key, slot);
      }
    }
    REQUIRE(table.count() == static_cast<int>(expected.size()));
    if (step % 100 != 0) continue;
    for (const auto& [there, slot] : expected) REQUIRE(table.find(there) == slot);
  }
  CHECK(refused > 1000);
}

TEST_CASE("the address of a remembered block is looked up only once", "[map][block_table]") {
  RecentBlocks<const int> recent;
  const int block = 7;
  int calls = 0;
  const auto find = [&] {
    ++calls;
    return &block;
  };
  const std::uint64_t key = BlockTable::key_of(-3, 0, 12);
  CHECK(recent.of(key, find) == &block);
  CHECK(recent.of(key, find) == &block);
  CHECK(calls == 1);
  // A null address is remembered, too.
  const std::uint64_t other = BlockTable::key_of(4, 5, 6);
  const auto none = [&]() -> const int* {
    ++calls;
    return nullptr;
  };
  CHECK(recent.of(other, none) == nullptr);
  CHECK(recent.of(other, none) == nullptr);
  CHECK(calls == 2);
}

}  // namespace
}  // namespace palpable
