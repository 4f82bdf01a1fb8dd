/// @file
/// A hash table of fixed size from blocks of space to slots. Only blocks that are in use have a
/// slot, so empty space takes no memory.
#pragma once

#include "palpable/common/base/contract.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpable {

/// Identifies cubes of space by three integers and gives each a slot in [0, capacity). Allocates in
/// its constructor only.
class BlockTable {
 public:
  static constexpr int kNone = -1;

  /// @param capacity  blocks, >= 1
  explicit BlockTable(int capacity) : slots_(size_of(capacity)) {
    places_.resize(std::max(2 * std::bit_ceil(size_of(capacity)), kTogether));
    free_.reserve(size_of(capacity));
    for (int slot = capacity; slot-- > 0;) free_.push_back(slot);
  }

  /// The key of block (x, y, z), each in [-2^20, 2^20).
  [[nodiscard]] static std::uint64_t key_of(int x, int y, int z) {
    constexpr std::uint64_t kMask = (1U << 21) - 1;
    return (static_cast<std::uint64_t>(x) & kMask) | (static_cast<std::uint64_t>(y) & kMask) << 21 |
           (static_cast<std::uint64_t>(z) & kMask) << 42;
  }

  /// (x, y, z) of a key.
  [[nodiscard]] static Eigen::Vector3i place_of(std::uint64_t key) {
    const auto number = [key](int shift) {
      // Shifted to the top and back, which repeats the sign bit.
      return static_cast<int>(static_cast<std::int64_t>(key << (43 - shift)) >> 43);
    };
    return {number(0), number(21), number(42)};
  }

  /// The slot of a block, or kNone when it has none.
  [[nodiscard]] int find(std::uint64_t key) const { return places_[place_with(key)].slot; }

  /// Gives a slot to a block that has none; kNone when all slots are in use.
  int insert(std::uint64_t key) {
    if (free_.empty()) return kNone;
    const int slot = free_.back();
    free_.pop_back();
    places_[place_with(key)] = {key, slot};
    slots_[at(slot)] = {key, true};
    return slot;
  }

  /// Frees a slot.
  void erase(int slot) {
    PALPABLE_EXPECT(used(slot), "only a slot that is in use can be freed");
    std::size_t gap = place_with(key(slot));
    // An entry behind the gap moves into it if a search for it would pass there (Knuth, TAOCP 3,
    // 6.4, algorithm R).
    for (std::size_t i = next(gap); places_[i].slot != kNone; i = next(i)) {
      const std::size_t gone = (i - first_place_of(places_[i].key)) & (places_.size() - 1);
      if (gone < ((i - gap) & (places_.size() - 1))) continue;
      places_[gap] = places_[i];
      gap = i;
    }
    places_[gap] = {};
    slots_[at(slot)].used = false;
    free_.push_back(slot);
  }

  [[nodiscard]] int capacity() const { return static_cast<int>(slots_.size()); }
  [[nodiscard]] int count() const { return capacity() - static_cast<int>(free_.size()); }
  [[nodiscard]] bool used(int slot) const { return slots_[at(slot)].used; }
  [[nodiscard]] std::uint64_t key(int slot) const { return slots_[at(slot)].key; }

 private:
  struct Slot {
    std::uint64_t key = 0;
    bool used = false;
  };
  struct Place {
    std::uint64_t key = 0;
    int slot = kNone;
  };
  // Entries of four blocks that are neighbours in x share one cache line, because half of all
  // look-ups go to a neighbour of the block before.
  static constexpr std::size_t kTogether = 4;

  [[nodiscard]] static std::size_t size_of(int capacity) {
    PALPABLE_EXPECT(capacity >= 1, "a table holds at least one block");
    return static_cast<std::size_t>(capacity);
  }
  [[nodiscard]] static std::size_t at(int slot) { return static_cast<std::size_t>(slot); }
  // Where the search for a key begins. Fibonacci hashing (TAOCP 3, 6.4) spreads neighbouring groups
  // over the table.
  [[nodiscard]] std::size_t first_place_of(std::uint64_t key) const {
    const auto group = static_cast<std::size_t>((key / kTogether * 0x9E3779B97F4A7C15ULL) >> 32);
    return (kTogether * group + key % kTogether) & (places_.size() - 1);
  }
  [[nodiscard]] std::size_t next(std::size_t place) const {
    return (place + 1) & (places_.size() - 1);
  }
  // The entry that holds a key, or the empty one into which it would be written.
  [[nodiscard]] std::size_t place_with(std::uint64_t key) const {
    std::size_t i = first_place_of(key);
    while (places_[i].slot != kNone && places_[i].key != key) i = next(i);
    return i;
  }

  std::vector<Slot> slots_;
  std::vector<Place> places_;  // entries of the hash table, at most half of them in use
  std::vector<int> free_;
};

/// A direct-mapped cache of the addresses of up to 512 blocks that were looked up last. Its 8 KiB
/// fit into the processor's L1 cache, and successive rows of an image need the same few hundred
/// blocks. Valid until a block is removed.
template <class Block>
class RecentBlocks {
 public:
  RecentBlocks() { known_.fill({kNoKey, nullptr}); }

  /// Stores the address of a block, which must not move as long as this object is used.
  void remember(std::uint64_t key, Block* block) { at(key) = {key, block}; }

  /// The address of the block with this key. If it is not stored, find() computes it; a null
  /// address is stored, too.
  template <class Find>
  [[nodiscard]] Block* of(std::uint64_t key, const Find& find) {
    Known& known = at(key);
    if (known.key != key) known = {key, find()};
    return known.block;
  }

 private:
  struct Known {
    std::uint64_t key;
    Block* block;
  };
  [[nodiscard]] Known& at(std::uint64_t key) {
    return known_[(key ^ key >> 18 ^ key >> 36) % known_.size()];
  }
  static constexpr std::uint64_t kNoKey = ~std::uint64_t{0};  // no block's key: those have 63 bits
  std::array<Known, 512> known_;
};

}  // namespace palpable
