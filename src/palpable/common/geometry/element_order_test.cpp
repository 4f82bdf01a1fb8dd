// Points in an order in which neighbours follow each other.
#include "palpable/common/geometry/element_order.h"

#include "tests/support/test.h"

#include <algorithm>
#include <limits>

namespace palpable {
namespace {

using Eigen::Matrix3Xd;

double mean_step(const Matrix3Xd& points, const std::vector<int>& order) {
  double sum = 0;
  for (std::size_t k = 1; k < order.size(); ++k) {
    sum += (points.col(order[k]) - points.col(order[k - 1])).norm();
  }
  return sum / static_cast<double>(order.size() - 1);
}

TEST_CASE("each point once, and neighbours follow each other", "[geometry]") {
  auto random = test::random_case(3);
  std::uniform_real_distribution<double> place(-2.0, 5.0);
  const Matrix3Xd points = Matrix3Xd::NullaryExpr(3, 4096, [&] { return place(random); });
  const std::vector<int> order = order_along_curve(points);
  std::vector<int> sorted = order;
  std::ranges::sort(sorted);
  REQUIRE(sorted.size() == 4096);
  for (int k = 0; k < 4096; ++k) CHECK(sorted[k] == k);
  // One of 4,096 cells that hold one point each is 7/16 wide, about as long as a step along the
  // curve. Two random points of the cube are 0.66 x 7 apart on average.
  CHECK(mean_step(points, order) < test::tolerance(2 * 7.0 / 16, "jumps of the curve included"));
}

TEST_CASE("points on a lattice of eight follow its curve", "[geometry]") {
  Matrix3Xd points(3, 8);
  for (int k = 0; k < 8; ++k) points.col(7 - k) = Eigen::Vector3d(k >> 2, (k >> 1) & 1, k & 1);
  CHECK(order_along_curve(points) == std::vector{7, 6, 5, 4, 3, 2, 1, 0});
}

TEST_CASE("equal points keep their order, and no points have none", "[geometry]") {
  CHECK(order_along_curve(Matrix3Xd::Constant(3, 3, 7.0)) == std::vector{0, 1, 2});
  CHECK(order_along_curve(Matrix3Xd(3, 0)).empty());
}

}  // namespace
}  // namespace palpable
