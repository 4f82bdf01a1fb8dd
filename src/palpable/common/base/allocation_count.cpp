#include "palpable/common/base/allocation_count.h"

#include <atomic>
#include <cstddef>

namespace {
std::atomic<int> g_allocations{0};
}  // namespace

// The linker (--wrap) sends every malloc, new and new[] of our own objects through these.
// Wrapping, rather than replacing operator new, leaves AddressSanitizer's bookkeeping intact.
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming): the linker sets names
extern "C" {
void* __real_malloc(std::size_t size);
void* __real__Znwm(std::size_t size);  // operator new
void* __real__Znam(std::size_t size);  // operator new[]

void* __wrap_malloc(std::size_t size) {
  ++g_allocations;
  return __real_malloc(size);
}
void* __wrap__Znwm(std::size_t size) {
  ++g_allocations;
  return __real__Znwm(size);
}
void* __wrap__Znam(std::size_t size) {
  ++g_allocations;
  return __real__Znam(size);
}
}
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)

namespace palpable {

int allocations_during(const std::function<void()>& work) {
  const int before = g_allocations;
  work();
  return g_allocations - before;
}

}  // namespace palpable
