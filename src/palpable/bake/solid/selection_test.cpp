#include "palpable/bake/solid/selection.h"

#include "palpable/common/base/error.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <limits>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Eigen::Vector3d;

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

const TetMesh kBox = box_tets({0, 0, 0}, {2, 1, 1}, 4, 2, 2);

TEST_CASE("a box chooses the nodes inside it and on its faces", "[solid][selection]") {
  const std::vector<int> nodes = nodes_in_box(kBox, {0.4, -kNoLimit, 0.0}, {1.0, kNoLimit, 0.5});
  CHECK(nodes.size() == 2 * 3 * 2);  // x = 0.5, 1; all y; z = 0, 0.5
  for (const int n : nodes) {
    CHECK((kBox.nodes(0, n) >= 0.4 && kBox.nodes(0, n) <= 1.0 && kBox.nodes(2, n) <= 0.5));
  }
}

TEST_CASE("a plane chooses the nodes near it, whatever the length of its normal",
          "[solid][selection]") {
  const std::vector<int> nodes = nodes_on_plane(kBox, {2, 0, 0}, {-3, 0, 0}, 1e-9);
  CHECK(nodes.size() == 9);
  for (const int n : nodes) CHECK(kBox.nodes(0, n) == 2.0);
  // x + y = 1.5 has three nodes in each of three layers
  CHECK(nodes_on_plane(kBox, {1.5, 0, 0}, {1, 1, 0}, 1e-9).size() == 9);
  CHECK(nodes_on_plane(kBox, {2, 0, 0}, {-3, 0, 0}, 0.51).size() == 18);
}

TEST_CASE("the nearest node is the nearest", "[solid][selection]") {
  const int n = nearest_node(kBox, {1.45, 0.6, -3});
  CHECK(kBox.nodes.col(n) == Vector3d(1.5, 0.5, 0));
}

TEST_CASE("the faces between the nodes of a side have its area and look outwards",
          "[solid][selection]") {
  const Eigen::Matrix3Xi skin = skin_triangles(kBox);
  const Eigen::Matrix3Xi end =
      triangles_between(skin, nodes_on_plane(kBox, {2, 0, 0}, {1, 0, 0}, 1e-9));
  CHECK(end.cols() == 8);
  Vector3d area = Vector3d::Zero();
  for (Eigen::Index t = 0; t < end.cols(); ++t) {
    const Vector3d a = kBox.nodes.col(end(0, t)), b = kBox.nodes.col(end(1, t)),
                   c = kBox.nodes.col(end(2, t));
    area += 0.5 * (b - a).cross(c - a);
  }
  CHECK((area - Vector3d(1, 0, 0)).norm() <= test::tolerance(1e-14, "rounding"));
}

TEST_CASE("a choice that misses the body says where the body is", "[solid][selection][errors]") {
  CHECK_THROWS_WITH(nodes_in_box(kBox, {3, 0, 0}, {4, 1, 1}),
                    Contains("(3, 0, 0)") && Contains("from (0, 0, 0) to (2, 1, 1)"));
  CHECK_THROWS_WITH(nodes_on_plane(kBox, {0, 0, 9}, {0, 0, 1}, 0.1), Contains("no node"));
  CHECK_THROWS_WITH(nodes_on_plane(kBox, {0, 0, 0}, {0, 0, 0}, 0.1), Contains("normal"));
  CHECK_THROWS_WITH(triangles_between(skin_triangles(kBox), std::vector<int>{0, 1}),
                    Contains("no triangle"));
}

}  // namespace
}  // namespace palpable
