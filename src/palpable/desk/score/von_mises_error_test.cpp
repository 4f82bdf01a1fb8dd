#include "palpable/desk/score/von_mises_error.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <cmath>

namespace palpable {
namespace {

TEST_CASE("the error of a stress is that of the worst vertex against the true maximum", "[score]") {
  const Eigen::Vector4d truth(1000, 4000, 0, 500);
  CHECK(von_mises_error(truth, truth) == 0);
  CHECK(von_mises_error(truth, Eigen::Vector4d(1000, 3600, 0, 500)) == Approx(0.1));
  CHECK(von_mises_error(truth, Eigen::Vector4d(1000, 3600, 1000, 500)) == Approx(0.25));
  CHECK(von_mises_error(truth, Eigen::Vector4d::Zero()) == Approx(1));  // a body at rest
  CHECK(von_mises_error(truth, 3 * truth) == Approx(2));
}

TEST_CASE("where the truth has no stress, only none is right", "[score]") {
  const Eigen::Vector2d none(0, 0);
  CHECK(von_mises_error(none, none) == 0);
  CHECK(std::isinf(von_mises_error(none, Eigen::Vector2d(0, 1))));
}

TEST_CASE("stresses of two skins are refused", "[score][errors]") {
  CHECK_THROWS_AS(von_mises_error(Eigen::Vector2d(0, 1), Eigen::Vector3d(0, 1, 2)),
                  ContractViolation);
  CHECK_THROWS_AS(von_mises_error({}, {}), ContractViolation);
}

}  // namespace
}  // namespace palpable
