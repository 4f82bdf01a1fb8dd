#include "palpable/common/base/huge_pages.h"

#include "tests/support/test.h"

#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace palpable {
namespace {

TEST_CASE("memory of huge pages begins on a page and holds what is put there", "[base]") {
  std::vector<int, HugePageAllocator<int>> numbers(1'000'000);
  CHECK(reinterpret_cast<std::uintptr_t>(numbers.data()) % kHugePage == 0);
  std::iota(numbers.begin(), numbers.end(), 0);
  auto copy = numbers;
  numbers.resize(2'000'000, -1);
  CHECK(reinterpret_cast<std::uintptr_t>(numbers.data()) % kHugePage == 0);
  CHECK(numbers[999'999] == 999'999);
  CHECK(numbers.back() == -1);
  numbers = std::move(copy);
  CHECK(numbers.size() == 1'000'000);
  CHECK(numbers.back() == 999'999);
}

}  // namespace
}  // namespace palpable
