#include "palpable/common/base/quantity.h"

#include "tests/support/test.h"

#include <cmath>

namespace palpable {
namespace {

TEST_CASE("a quantity is a number and a unit of its kind", "[base]") {
  CHECK(to_quantity("7mm", Quantity::kLength) == 7 * 1e-3);
  CHECK(to_quantity("7 mm", Quantity::kLength) == 7 * 1e-3);
  CHECK(to_quantity("-1.5e1 cm", Quantity::kLength) == -15 * 1e-2);
  CHECK(to_quantity("2 m", Quantity::kLength) == 2.0);
  CHECK(to_quantity("60 kPa", Quantity::kPressure) == 60e3);
  CHECK(to_quantity("3 mN", Quantity::kForce) == 3 * 1e-3);
  CHECK(to_quantity("1 g/cm^3", Quantity::kDensity) == 1000.0);
  for (const Quantity kind : {Quantity::kLength, Quantity::kPressure, Quantity::kPerPressure,
                              Quantity::kForce, Quantity::kDensity, Quantity::kAcceleration}) {
    CHECK(to_quantity(example_of(kind), kind).has_value());
  }
}

TEST_CASE("a text without a unit, or with another's, is no quantity", "[base][errors]") {
  for (const char* text : {"", "7", "mm", "7 kPa", "7 mm ", "7mmm", "0x7mm", "7,5 mm", "+7mm"}) {
    CAPTURE(text);
    CHECK_FALSE(to_quantity(text, Quantity::kLength).has_value());
  }
}

}  // namespace
}  // namespace palpable
