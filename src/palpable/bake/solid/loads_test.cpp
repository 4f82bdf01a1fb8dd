#include "palpable/bake/solid/loads.h"

#include "palpable/bake/solid/selection.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <array>
#include <vector>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using test::tolerance;

// A box whose inner nodes have been moved about, with elements of both kinds.
std::array<TetMesh, 2> boxes() {
  TetMesh mesh = box_tets({0, 0, 0}, {2, 1, 1.5}, 3, 3, 3);
  auto random = test::random_case(5);
  std::uniform_real_distribution<double> shift(-0.08, 0.08);
  const Vector3d top(2, 1, 1.5);
  for (auto X : mesh.nodes.colwise()) {
    for (int i = 0; i < 3; ++i) {
      if (X[i] > 1e-9 && X[i] < top[i] - 1e-9) X[i] += shift(random);
    }
  }
  return {mesh, with_edge_nodes(mesh)};
}

double largest(const Eigen::MatrixXd& A) { return A.cwiseAbs().maxCoeff(); }

TEST_CASE("the weight of a body is its volume times density times gravity, at its centre",
          "[solid][load]") {
  for (const TetMesh& mesh : boxes()) {
    const Matrix3Xd force = gravity_load(mesh, 1000, {0, 0, -10});
    CHECK(largest(force.rowwise().sum() - Vector3d(0, 0, -30e3)) <= tolerance(1e-7, "rounding"));
    Vector3d moment = Vector3d::Zero();
    for (int n = 0; n < mesh.node_count(); ++n) {
      moment += Vector3d(mesh.nodes.col(n)).cross(Vector3d(force.col(n)));
    }
    CHECK(largest(moment - Vector3d(1, 0.5, 0.75).cross(Vector3d(0, 0, -30e3))) <=
          tolerance(1e-7, "rounding"));
  }
}

TEST_CASE("a load does the work of its density on every displacement of the element",
          "[solid][load]") {
  // b(X) . v(X) with b linear, v of the element's own degree, integrated by hand over the box.
  const auto b = [](const Vector3d& X) { return Vector3d(X[0], 2, X[1]); };
  const auto boxes_of_both = boxes();
  const auto work = [&](const TetMesh& mesh, auto&& v) {
    const Matrix3Xd force = body_force_load(mesh, b);
    double sum = 0.0;
    for (int n = 0; n < mesh.node_count(); ++n) sum += force.col(n).dot(v(mesh.nodes.col(n)));
    return sum;
  };
  const auto linear = [](const Vector3d& X) { return Vector3d(X[0], X[2], 1); };
  // int x^2 + 2 z + y = 8/3 * 1.5 + 2 * 0.75 * 3 + 0.5 * 3
  for (const TetMesh& mesh : boxes_of_both) {
    CHECK(work(mesh, linear) == Approx(4 + 4.5 + 1.5).epsilon(tolerance(1e-12, "rounding")));
  }
  const auto quadratic = [](const Vector3d& X) { return Vector3d(X[1] * X[1], X[0] * X[2], 0); };
  // int x y^2 + 2 x z = 2 * 1/3 * 1.5 + 2 * 2 * 1.125 * 1
  CHECK(work(boxes_of_both[1], quadratic) == Approx(1 + 4.5).epsilon(tolerance(1e-12, "rounding")));
}

TEST_CASE("a traction does its work on the face that it acts on", "[solid][load]") {
  for (const TetMesh& mesh : boxes()) {
    const Eigen::Matrix3Xi end =
        triangles_between(skin_triangles(mesh), nodes_on_plane(mesh, {2, 0, 0}, {1, 0, 0}, 1e-9));
    const Matrix3Xd force =
        traction_load(mesh, end, [](const Vector3d& X, const Vector3d& n) -> Vector3d {
          return X[1] * n + Vector3d(0, 0, X[2]);
        });
    // Resultant (int y, 0, int z) over 1 x 1.5, and its moment about the corner (2, 0, 0).
    CHECK(largest(force.rowwise().sum() - Vector3d(0.75, 0, 1.125)) <=
          tolerance(1e-13, "rounding"));
    double moment_z = 0.0;  // int -y t_x
    for (int n = 0; n < mesh.node_count(); ++n) {
      if (mesh.nodes(0, n) != 2.0) CHECK(force.col(n) == Vector3d::Zero());
      moment_z -= mesh.nodes(1, n) * force(0, n);
    }
    CHECK(moment_z == Approx(-0.5).epsilon(tolerance(1e-12, "rounding")));
    // The same from values at the corners: the field is linear.
    Matrix3Xd nodal = Matrix3Xd::Zero(3, mesh.node_count());
    nodal.row(0) = mesh.nodes.row(1);
    nodal.row(2) = mesh.nodes.row(2);
    CHECK(largest(traction_load(mesh, end, nodal) - force) <= tolerance(1e-13, "rounding"));
  }
}

TEST_CASE("a pressure on the whole skin has no resultant and pushes inwards", "[solid][load]") {
  for (const TetMesh& mesh : boxes()) {
    const Matrix3Xd force = pressure_load(mesh, skin_triangles(mesh), 100);
    CHECK(largest(force.rowwise().sum()) <= tolerance(1e-11, "rounding"));
    // Its work on v = X is -p int n . X = -3 p V.
    CHECK(force.cwiseProduct(mesh.nodes).sum() ==
          Approx(-900.0).epsilon(tolerance(1e-12, "rounding")));
  }
}

TEST_CASE("loads that are no numbers are refused", "[solid][load][errors]") {
  const TetMesh mesh = boxes()[0];
  CHECK_THROWS_WITH(gravity_load(mesh, 0, {0, 0, -10}), Contains("density is 0"));
  CHECK_THROWS_WITH(gravity_load(mesh, 1000, {0, 0, NAN}), Contains("gravity"));
  CHECK_THROWS_WITH(pressure_load(mesh, skin_triangles(mesh), INFINITY), Contains("pressure"));
}

TEST_CASE("a patch load is one newton in total along its direction, shared by weight",
          "[solid][load]") {
  const std::array nodes{4, 1, 2};
  const std::array weights{1.0, 2.0, 5.0};
  const Eigen::Vector3d direction(0, 3, -4);
  const Eigen::Matrix3Xd f = patch_force(6, nodes, weights, direction);
  REQUIRE(f.cols() == 6);
  CHECK((f.rowwise().sum() - direction / 5.0).norm() <= tolerance(1e-15, "three roundings"));
  CHECK((f.col(2) - direction / 8.0).norm() <= tolerance(1e-15, "one division"));
  CHECK(f.col(0).norm() + f.col(3).norm() + f.col(5).norm() == 0.0);
}

TEST_CASE("a patch that cannot carry a load is refused", "[solid][load][errors]") {
  const std::vector<int> nodes{0, 1};
  const std::vector<double> weights{1, 1}, zeros{0, 0}, negative{1, -1};
  const Eigen::Vector3d up(0, 0, 1);
  CHECK_THROWS_WITH(patch_force(3, {}, {}, up), Contains("empty"));
  CHECK_THROWS_WITH(patch_force(1, nodes, weights, up), Contains("node 1"));
  CHECK_THROWS_WITH(patch_force(3, nodes, zeros, up), Contains("all zero"));
  CHECK_THROWS_WITH(patch_force(3, nodes, negative, up), Contains("-1"));
  CHECK_THROWS_WITH(patch_force(3, nodes, weights, Eigen::Vector3d::Zero()), Contains("direction"));
  CHECK_THROWS_AS(patch_force(3, nodes, std::vector<double>{1}, up), ContractViolation);
}

}  // namespace

}  // namespace palpable
