/// @file
/// The memory behind a BlockTable's slots: taken by slabs when a slot is first used, never moved
/// and never given back.
#pragma once

#include "palpable/base/huge_pages.h"

#include <cstddef>
#include <vector>

namespace palpable {

template <class Block>
class SlabStore {
 public:
  /// The block of a slot, >= 0; what it held before, or undefined. Takes memory up to it.
  Block& take(int slot) {
    while (slot >= slots()) slabs_.emplace_back(kSlab);
    return (*this)[slot];
  }

  /// Of a slot below slots().
  [[nodiscard]] Block& operator[](int slot) {
    const auto i = static_cast<std::size_t>(slot);
    return slabs_[i / kSlab][i % kSlab];
  }
  [[nodiscard]] const Block& operator[](int slot) const {
    const auto i = static_cast<std::size_t>(slot);
    return slabs_[i / kSlab][i % kSlab];
  }

  /// Slots that have memory: [0, slots()).
  [[nodiscard]] int slots() const { return static_cast<int>(kSlab * slabs_.size()); }

 private:
  static constexpr std::size_t kSlab = kHugePage / sizeof(Block);
  static_assert(kSlab > 0);
  using Slab = std::vector<Block, HugePageAllocator<Block>>;
  std::vector<Slab> slabs_;  // of one page each; moved, but not what is in them
};

}  // namespace palpable
