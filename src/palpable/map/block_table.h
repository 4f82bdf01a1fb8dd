/// @file
/// Which blocks of space are kept, and where: a hash table of fixed size, so that what looks
/// sparse takes memory only where something was seen.
#pragma once

#include "palpable/base/contract.h"

#include <Eigen/Core>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpable {

/// Names cubes of space by three whole numbers and gives each a slot in [0, capacity). Takes its
/// memory when it is made and none later.
class BlockTable {
 public:
  static constexpr int kNone = -1;

  /// @param capacity  blocks, >= 1
  explicit BlockTable(int capacity) : slots_(size_of(capacity)) {
    heads_.assign(std::bit_ceil(size_of(capacity)) * 2, kNone);
    free_.reserve(size_of(capacity));
    for (int slot = capacity; slot-- > 0;) free_.push_back(slot);
  }

  /// Coordinates of blocks must lie in [-2^20, 2^20).
  [[nodiscard]] static std::uint64_t key_of(int x, int y, int z) {
    constexpr std::uint64_t kMask = (1U << 21) - 1;
    return (static_cast<std::uint64_t>(x) & kMask) | (static_cast<std::uint64_t>(y) & kMask) << 21 |
           (static_cast<std::uint64_t>(z) & kMask) << 42;
  }

  [[nodiscard]] static Eigen::Vector3i place_of(std::uint64_t key) {
    const auto number = [key](int shift) {
      // Moved to the top and back, so that the sign comes along.
      return static_cast<int>(static_cast<std::int64_t>(key << (43 - shift)) >> 43);
    };
    return {number(0), number(21), number(42)};
  }

  /// The slot of a block, or kNone.
  [[nodiscard]] int find(std::uint64_t key) const {
    int slot = heads_[bucket_of(key)];
    while (slot != kNone && slots_[at(slot)].key != key) slot = slots_[at(slot)].next;
    return slot;
  }

  /// A slot for a block that has none; kNone when all are taken.
  int insert(std::uint64_t key) {
    if (free_.empty()) return kNone;
    const int slot = free_.back();
    free_.pop_back();
    int& head = heads_[bucket_of(key)];
    slots_[at(slot)] = {key, head, true};
    head = slot;
    return slot;
  }

  /// Gives a slot back.
  void erase(int slot) {
    PALPABLE_EXPECT(used(slot), "only a block that is there can be removed");
    int* link = &heads_[bucket_of(key(slot))];
    while (*link != slot) link = &slots_[at(*link)].next;
    *link = slots_[at(slot)].next;
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
    int next = kNone;  // of the same bucket
    bool used = false;
  };
  [[nodiscard]] static std::size_t size_of(int capacity) {
    PALPABLE_EXPECT(capacity >= 1, "a table holds at least one block");
    return static_cast<std::size_t>(capacity);
  }
  [[nodiscard]] static std::size_t at(int slot) { return static_cast<std::size_t>(slot); }
  [[nodiscard]] std::size_t bucket_of(std::uint64_t key) const {
    // Fibonacci hashing (Knuth, TAOCP 3, 6.4): neighbours land far apart.
    return static_cast<std::size_t>((key * 0x9E3779B97F4A7C15ULL) >> 32) & (heads_.size() - 1);
  }

  std::vector<Slot> slots_;
  std::vector<int> heads_;
  std::vector<int> free_;
};

}  // namespace palpable
