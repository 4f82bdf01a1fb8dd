#include "palpable/reduced/reduced_body.h"

#include "palpable/base/contract.h"
#include "tests/support/allocations.h"
#include "tests/support/bodies.h"
#include "tests/support/test.h"

#include <array>

namespace palpable {
namespace {

using test::tolerance;

TEST_CASE("the level of a depth inverts the table of depths", "[reduced]") {
  ReducedBody body = test::pressed_ball();
  const auto last = body.levels().size() - 1;
  body.press_depth.col(2) << 0, 1e-3, 3e-3, 4e-3, 9e-3;  // not linear
  for (Eigen::Index k = 0; k <= last; ++k) {
    CHECK(level_of_press_depth(body, 2, body.press_depth(k, 2)) == body.levels()[k]);
  }
  CHECK(level_of_press_depth(body, 2, 2e-3) ==
        Approx(0.375).epsilon(tolerance(1e-14, "one interpolation")));
}

TEST_CASE("the level grows with the depth and stays between 0 and 1", "[reduced][law]") {
  const ReducedBody body = test::pressed_ball();
  double before = -1.0;
  for (double depth = -2e-3; depth < 15e-3; depth += 1e-4) {
    const double level = level_of_press_depth(body, 0, depth);
    CHECK((level >= before && level >= 0.0 && level <= 1.0));
    before = level;
  }
  CHECK(before == 1.0);
  CHECK(level_of_press_depth(body, 0, std::nan("")) == 0.0);  // nothing was measured
  CHECK_THROWS_AS(level_of_press_depth(body, 6, 0.0), ContractViolation);
}

TEST_CASE("von Mises stress of one pull, of pure shear and of pressure", "[reduced]") {
  const std::array<float, 18> stress{7, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 5, 5, 5, 0, 0, 0};
  std::array<float, 3> result{};
  CHECK(test::allocations_during([&] { von_mises(stress, result); }) == 0);
  CHECK(result[0] == 7.0f);
  CHECK(result[1] == Approx(2.0 * std::sqrt(3.0)).epsilon(tolerance(1e-7, "single precision")));
  CHECK(result[2] == 0.0f);
}

}  // namespace
}  // namespace palpable
