#include "palpable/desk/score/force_error.h"

#include "tests/support/test.h"

#include <cmath>
#include <vector>

namespace palpable {
namespace {

using Forces = std::vector<Eigen::Vector3d>;

TEST_CASE("the error of a force is that of the resultants", "[score]") {
  const Eigen::Vector3d truth(0, 3, -4);
  CHECK(force_error(truth, Forces{truth}) == 0);
  CHECK(force_error(truth, Forces{{0, 3, -3}}) == Approx(0.2));
  CHECK(force_error(truth, Forces{2 * truth}) == Approx(1));
  CHECK(force_error(truth, Forces{-truth}) == Approx(2));  // the opposite force
  // The forces of the two fingers of a squeeze add up.
  CHECK(force_error(truth, Forces{{5, 3, 0}, {-5, 0, -4}}) == 0);
  CHECK(force_error(truth, Forces{{3, 3, -4}, {0, 0, 0}}) == Approx(0.6));
}

TEST_CASE("a touch that was not felt counts as rest", "[score]") {
  CHECK(force_error({0, 3, -4}, {}) == Approx(1));
}

TEST_CASE("where nothing presses, only no force is right", "[score]") {
  CHECK(force_error(Eigen::Vector3d::Zero(), {}) == 0);
  CHECK(std::isinf(force_error(Eigen::Vector3d::Zero(), Forces{{1, 0, 0}})));
}

}  // namespace
}  // namespace palpable
