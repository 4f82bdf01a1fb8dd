/// @file
/// The memory behind a BlockTable's slots. It grows by slabs of one huge page when a slot is first
/// used; blocks are never moved, and memory is never released before destruction.
#pragma once

#include "palpable/common/base/huge_pages.h"

#include <cstddef>
#include <vector>

namespace palpable {

template <class Block>
class SlabStore {
 public:
  /// The block of a slot >= 0. Allocates memory for it and all slots before it if necessary. Its
  /// content is unchanged if it had memory, undefined otherwise.
  Block& provide(int slot) {
    while (slot >= slots()) slabs_.emplace_back(kSlab);
    return (*this)[slot];
  }

  /// The block of a slot below slots().
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
  std::vector<Slab> slabs_;  // of one page each
};

}  // namespace palpable
