/// @file
/// Memory in pages of 2 MiB instead of 4 KiB, if the system offers them. With small pages, random
/// look-ups in a large container wait for the page table as often as for the data.
#pragma once

#include <cstddef>
#include <new>
#include <sys/mman.h>

namespace palpable {

inline constexpr std::size_t kHugePage = std::size_t{2} << 20;  // bytes, of x86-64 and most ARM

/// Allocator of containers that are megabytes large. Each allocation begins on a page of its own.
template <class T>
class HugePageAllocator {
 public:
  using value_type = T;

  HugePageAllocator() = default;
  template <class Other>
  explicit HugePageAllocator(const HugePageAllocator<Other>& /*other*/) {}

  /// @throws std::bad_alloc
  [[nodiscard]] T* allocate(std::size_t count) {
    void* memory = ::operator new (count * sizeof(T), std::align_val_t{kHugePage});
#ifdef MADV_HUGEPAGE
    madvise(memory, count * sizeof(T), MADV_HUGEPAGE);  // a hint; if ignored, access is slower
#endif
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t /*count*/) {
    ::operator delete (memory, std::align_val_t{kHugePage});
  }

  template <class Other>
  [[nodiscard]] bool operator==(const HugePageAllocator<Other>& /*other*/) const {
    return true;
  }
};

}  // namespace palpable
