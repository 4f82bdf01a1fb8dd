#include "palpable/desk/score/skin_projection.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

namespace palpable {
namespace {

using test::tolerance;

TEST_CASE("on the same skin every value stays as it is", "[score]") {
  const SurfaceMesh skin = sphere_surface({0.1, 0, 0}, 0.05, 2);
  const SkinProjection same(skin, skin.vertices);
  const Eigen::Matrix3Xd u = 0.1 * skin.vertices.array().sin();
  const Eigen::VectorXd stress = skin.vertices.row(2).transpose();
  const double rounding = tolerance(1e-15, "weights of a corner, of numbers below 1");
  CHECK((same.vectors(u) - u).cwiseAbs().maxCoeff() <= rounding);
  CHECK((same.numbers(stress) - stress).cwiseAbs().maxCoeff() <= rounding);
}

TEST_CASE("a linear field is the same on any triangulation of a box", "[score]") {
  // A box of 12 triangles; points on its faces, and one 1 mm above the middle of its top.
  const SurfaceMesh box = box_surface({0, 0, 0}, {0.1, 0.2, 0.3});
  Eigen::Matrix3Xd points(3, 3);
  points.col(0) << 0.03, 0.05, 0.3;
  points.col(1) << 0.1, 0.11, 0.12;
  points.col(2) << 0.05, 0.1, 0.301;
  const SkinProjection projection(box, points);
  const Eigen::VectorXd field = (Eigen::RowVector3d(1, 2, 3) * box.vertices).transpose();
  const Eigen::VectorXd found = projection.numbers(field);
  const double rounding = tolerance(1e-15, "sums of three numbers near 1");
  CHECK(std::abs(found[0] - (0.03 + 0.10 + 0.9)) <= rounding);
  CHECK(std::abs(found[1] - (0.1 + 0.22 + 0.36)) <= rounding);
  CHECK(std::abs(found[2] - (0.05 + 0.2 + 0.9)) <= rounding);  // the value at the point below it
  const Eigen::Matrix3Xd moved = projection.vectors(2.0 * box.vertices);
  CHECK((moved.leftCols(2) - 2.0 * points.leftCols(2)).cwiseAbs().maxCoeff() <= rounding);
}

TEST_CASE("a field of another skin is refused", "[score][errors]") {
  const SurfaceMesh box = box_surface({0, 0, 0}, {1, 1, 1});
  const SkinProjection projection(box, box.vertices);
  CHECK_THROWS_AS(projection.vectors(Eigen::Matrix3Xd::Zero(3, 7)), ContractViolation);
  CHECK_THROWS_AS(projection.numbers(Eigen::VectorXd::Zero(9)), ContractViolation);
  CHECK_THROWS_AS(SkinProjection(SurfaceMesh{}, box.vertices), ContractViolation);
}

}  // namespace
}  // namespace palpable
