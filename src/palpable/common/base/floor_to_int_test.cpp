#include "palpable/common/base/floor_to_int.h"

#include "tests/support/test.h"

#include <cmath>
#include <limits>

namespace palpable {
namespace {

TEST_CASE("floor_to_int agrees with std::floor next to whole numbers and for large ones",
          "[base]") {
  const float below = std::numeric_limits<float>::lowest(), above = -below;
  for (int k = -70; k <= 70; ++k) {
    const auto at = static_cast<float>(k);
    for (const float a : {std::nextafter(at, below), at, std::nextafter(at, above), at + 0.5F}) {
      CAPTURE(a);
      CHECK(floor_to_int(a) == static_cast<int>(std::floor(a)));
      CHECK(floor_to_int(static_cast<double>(a)) == static_cast<int>(std::floor(a)));
    }
  }
  for (const double a : {-2147483647.5, -1048576.25, 1048575.75, 2147483646.5}) {
    CAPTURE(a);
    CHECK(floor_to_int(a) == static_cast<int>(std::floor(a)));
  }
}

}  // namespace
}  // namespace palpable
