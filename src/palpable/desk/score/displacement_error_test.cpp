#include "palpable/desk/score/displacement_error.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <cmath>

namespace palpable {
namespace {

// Two vertices; the area of the second is three times that of the first.
const Eigen::Vector2d kAreas(1e-4, 3e-4);

Eigen::Matrix3Xd two(const Eigen::Vector3d& first, const Eigen::Vector3d& second) {
  Eigen::Matrix3Xd u(3, 2);
  u.col(0) = first;
  u.col(1) = second;
  return u;
}

TEST_CASE("the error of a displacement is the one computed by hand", "[score]") {
  // True displacements of 4 mm and 1 mm: weighted squares 1 x 16 + 3 x 1 = 19. Errors of 0 and 2
  // mm: 3 x 4 = 12.
  const Eigen::Matrix3Xd truth = two({0.004, 0, 0}, {0, 0.001, 0});
  const Eigen::Matrix3Xd found = two({0.004, 0, 0}, {0, 0.001, 0.002});
  const DisplacementError error = displacement_error(truth, found, kAreas);
  CHECK(error.relative == Approx(std::sqrt(12.0 / 19.0)));
  CHECK(error.worst == Approx(0.002));
}

TEST_CASE("the truth has no error; a body at rest and twice the truth have a relative error of 1",
          "[score]") {
  const Eigen::Matrix3Xd truth = two({0.004, 0, 0}, {0, 0.001, 0.002});
  CHECK(displacement_error(truth, truth, kAreas).relative == 0);
  CHECK(displacement_error(truth, truth, kAreas).worst == 0);
  for (const double times : {0.0, 2.0}) {
    INFO(times << " times the truth");
    const DisplacementError error = displacement_error(truth, times * truth, kAreas);
    CHECK(error.relative == Approx(1));
    CHECK(error.worst == Approx(0.004));
  }
}

TEST_CASE("where the truth is at rest, only rest is right", "[score]") {
  const Eigen::Matrix3Xd rest = two({0, 0, 0}, {0, 0, 0});
  CHECK(displacement_error(rest, rest, kAreas).relative == 0);
  const DisplacementError error = displacement_error(rest, two({0.001, 0, 0}, {0, 0, 0}), kAreas);
  CHECK(std::isinf(error.relative));
  CHECK(error.worst == 0.001);
}

TEST_CASE("displacements of two skins are refused", "[score][errors]") {
  const Eigen::Matrix3Xd u = two({0, 0, 0}, {0, 0, 0});
  CHECK_THROWS_AS(displacement_error(u, u.leftCols(1), kAreas), ContractViolation);
  CHECK_THROWS_AS(displacement_error(u, u, Eigen::Vector3d::Ones()), ContractViolation);
}

}  // namespace
}  // namespace palpable
