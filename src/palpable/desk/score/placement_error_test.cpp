#include "palpable/desk/score/placement_error.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

namespace palpable {
namespace {

using Eigen::Vector3d;
using test::tolerance;

// Two vertices: the base, and one 100 mm above it.
Eigen::Matrix3Xd rod() {
  Eigen::Matrix3Xd rest = Eigen::Matrix3Xd::Zero(3, 2);
  rest(2, 1) = 0.1;
  return rest;
}

TEST_CASE("a body drawn 3 mm beside its position has an error of 3 mm for any camera pose",
          "[score]") {
  Rigid3 truth = Rigid3::Identity();
  truth.linear() = Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  truth.translation() = Vector3d(0.1, -0.2, 0.4);
  CHECK(placement_error(rod(), truth, truth) == 0);
  Rigid3 drawn = truth;
  drawn.translation() += Vector3d(0, 0.003, 0);
  CHECK(placement_error(rod(), truth, drawn) == Approx(0.003));
}

TEST_CASE("the error of a tilted body is the displacement of its top", "[score]") {
  Rigid3 drawn = Rigid3::Identity();
  drawn.linear() = Eigen::AngleAxisd(0.2, Vector3d::UnitX()).toRotationMatrix();
  CHECK(placement_error(rod(), Rigid3::Identity(), drawn) == Approx(2 * 0.1 * std::sin(0.1)));
  CHECK_THROWS_AS(placement_error(Eigen::Matrix3Xd(3, 0), drawn, drawn), ContractViolation);
}

}  // namespace
}  // namespace palpable
