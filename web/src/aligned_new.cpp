// Memory of `new` begins at a multiple of 16 bytes, as glibc's does. Emscripten's malloc promises
// 8, and where an array begins decides in which order Eigen adds its numbers: other bytes.

#include <cstddef>
#include <cstdlib>
#include <new>

void* operator new(std::size_t size) {
  constexpr std::size_t kAlignment = 16;
  const std::size_t whole = (size + kAlignment - 1) / kAlignment * kAlignment;
  if (whole >= size) {
    if (void* const memory = std::aligned_alloc(kAlignment, whole > 0 ? whole : kAlignment)) {
      return memory;
    }
  }
  throw std::bad_alloc();
}
void* operator new[](std::size_t size) { return operator new(size); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
