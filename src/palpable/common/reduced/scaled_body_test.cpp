#include "palpable/common/reduced/scaled_body.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/reduced/loaded_body.h"
#include "tests/support/bodies.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/test.h"

#include <array>
#include <limits>
#include <vector>

namespace palpable {
namespace {

TEST_CASE("a body of three times the size is pressed three times as deep by nine times the force",
          "[reduced]") {
  const ReducedBody small = test::DentedSphere{}.body();
  const ReducedBody large = scaled(small, 3);
  CHECK(large.surface.vertices == 3 * small.surface.vertices);
  CHECK(large.press_depth == 3 * small.press_depth);
  CHECK(large.sites[1].full_load == Approx(9 * small.sites[1].full_load));
  CHECK(large.sites[1].direction == small.sites[1].direction);
  const std::array mu{1.0, 0.7};
  const auto size = static_cast<std::size_t>(small.displacement.value_count());
  std::vector<float> u(size), three_u(size);
  small.displacement.evaluate(mu, u);
  large.displacement.evaluate(mu, three_u);
  for (std::size_t i = 0; i < size; ++i) CHECK(three_u[i] == Approx(3 * u[i]).margin(1e-12));
  CHECK(large.stress.modes() == small.stress.modes());
  CHECK(level_of_press_depth(large, 1, 0.03) == Approx(level_of_press_depth(small, 1, 0.01)));
}

TEST_CASE("under several loads, too", "[reduced][several]") {
  const ReducedBody small = test::with_several(test::pressed_ball(0.05, 0.01, 1));
  const ReducedBody large = scaled(small, 3);
  LoadedBody of_small = LoadedBody::make(small).value(), of_large = LoadedBody::make(large).value();
  CHECK(large.several->reactions[0].full_load == Approx(9 * small.several->reactions[0].full_load));
  const std::array<PlacedLoad, 2> loads{PlacedLoad{4, 0.6}, PlacedLoad{6, 0.4}};
  REQUIRE(of_small.solve(loads).ok());
  REQUIRE(of_large.solve(loads).ok());
  CHECK(of_small.press_depth(4) > 0);
  CHECK(of_large.press_depth(4) ==
        Approx(3 * of_small.press_depth(4)).epsilon(test::tolerance(1e-5, "where Newton ends")));
}

TEST_CASE("a body of no size is refused", "[reduced][errors]") {
  const ReducedBody body = test::DentedSphere{}.body();
  CHECK_THROWS_AS(scaled(body, 0), ContractViolation);
  CHECK_THROWS_AS(scaled(body, std::numeric_limits<double>::infinity()), ContractViolation);
}

}  // namespace
}  // namespace palpable
