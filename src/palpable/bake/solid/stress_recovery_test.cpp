#include "palpable/bake/solid/stress_recovery.h"

#include "palpable/bake/solid/stress.h"
#include "palpable/common/geometry/quadrature.h"
#include "palpable/common/geometry/shape_gradients.h"
#include "tests/support/test.h"

#include <Eigen/Dense>

#include <array>
#include <cmath>

namespace palpable {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::tolerance;

TetMesh cube(int cells, bool quadratic, double distortion) {
  TetMesh mesh = box_tets({0, 0, 0}, {1, 1, 1}, cells, cells, cells);
  auto random = test::random_case(7);
  std::uniform_real_distribution<double> shift(-distortion / cells, distortion / cells);
  for (auto X : mesh.nodes.colwise()) {
    if ((X.array() == 0.0).any() || (X.array() == 1.0).any()) continue;
    for (double& x : X) x += shift(random);
  }
  return quadratic ? with_edge_nodes(mesh) : mesh;
}

TEST_CASE("a stress that is linear in space is recovered exactly, up to the corners",
          "[solid][recovery]") {
  for (const bool quadratic : {false, true}) {
    const TetMesh mesh = cube(3, quadratic, 0.2);
    Eigen::Matrix<double, 6, 4> coefficients;
    coefficients.setRandom();
    const auto exact = [&](const Vector3d& X) -> Eigen::Matrix<double, 6, 1> {
      return coefficients * Eigen::Vector4d(1, X[0], X[1], X[2]);
    };
    const int Q = quadratic ? 4 : 1;
    StressField points(6, Q * mesh.tet_count());
    for (int e = 0; e < mesh.tet_count(); ++e) {
      for (int q = 0; q < Q; ++q) {
        const Eigen::Vector4d L =
            quadratic ? four_point_rule()[q].barycentric : Eigen::Vector4d::Constant(0.25);
        points.col(Q * e + q) = exact(mesh.nodes(Eigen::all, mesh.tets.col(e)) * L);
      }
    }
    const StressRecovery recovery(mesh);
    CHECK(recovery.averaged_nodes() == 0);
    const StressField nodal = recovery.apply(points);
    for (int n = 0; n < mesh.node_count(); ++n) {
      CHECK((nodal.col(n) - exact(mesh.nodes.col(n))).norm() <= tolerance(1e-12, "rounding"));
    }
  }
}

TEST_CASE("a body of one element has the element's stress at its nodes", "[solid][recovery]") {
  TetMesh one = cube(1, false, 0);
  one.tets = one.tets.leftCols<1>().eval();
  const StressRecovery recovery(one);
  CHECK(recovery.averaged_nodes() == 4);
  StressField points(6, 1);
  points << 1, 2, 3, 4, 5, 6;
  const StressField nodal = recovery.apply(points);
  for (const int n : one.tets.col(0)) CHECK(nodal.col(n) == points.col(0));
}

// (6 x N) mean over the elements around each node, weighted with their undeformed volumes, as many
// programs compute it. At the boundary it is first order in the element size, because all elements
// lie to one side of the node.
StressField averaged_cauchy_stress(const SolidModel& model, const Eigen::Matrix3Xd& u) {
  const TetMesh& mesh = model.mesh;
  const StressField elements = element_cauchy_stress(model, u);
  StressField nodal = StressField::Zero(6, mesh.node_count());
  Eigen::VectorXd weight = Eigen::VectorXd::Zero(mesh.node_count());
  for (int e = 0; e < mesh.tet_count(); ++e) {
    const double V = shape_gradients(mesh, e).volume;
    const auto add = [&](int n) {
      nodal.col(n) += V * elements.col(e);
      weight[n] += V;
    };
    for (const int n : mesh.tets.col(e)) add(n);
    if (!mesh.is_quadratic()) continue;
    for (const int n : mesh.edge_nodes.col(e)) add(n);
  }
  for (int n = 0; n < mesh.node_count(); ++n) {
    if (weight[n] > 0.0) nodal.col(n) /= weight[n];
  }
  return nodal;
}

struct Errors {
  double inside, skin;  // rms over nodes
};

// Error of the nodal stress of a smooth displacement taken at the nodes.
std::array<Errors, 2> errors(int cells, bool quadratic) {
  SolidModel model;
  model.mesh = cube(cells, quadratic, 0.1);
  model.material = material_from_young("neo-hookean", 1.0, 0.3);
  const auto displacement = [](const Vector3d& X) -> Vector3d {
    return 0.1 * Vector3d(std::sin(2 * X[0] + X[1]), std::cos(1.5 * X[1] + 2 * X[2]),
                          std::sin(2 * X[2]) * std::cos(X[0]));
  };
  const auto exact = [&](const Vector3d& X) {
    Matrix3d F = Matrix3d::Identity();
    const double h = 1e-5;
    for (int k = 0; k < 3; ++k) {
      const Vector3d step = h * Vector3d::Unit(k);
      F.col(k) += (displacement(X + step) - displacement(X - step)) / (2 * h);
    }
    const Matrix3d s = first_piola(model.material, F) * F.transpose() / F.determinant();
    return Eigen::Matrix<double, 6, 1>(s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(2, 0));
  };
  const int N = model.mesh.node_count();
  Eigen::Matrix3Xd u(3, N);
  for (int n = 0; n < N; ++n) u.col(n) = displacement(model.mesh.nodes.col(n));
  std::array<Errors, 2> result{};
  const std::array fields{nodal_cauchy_stress(model, u), averaged_cauchy_stress(model, u)};
  for (std::size_t k = 0; k < 2; ++k) {
    double inside = 0, skin = 0;
    int inside_count = 0, skin_count = 0;
    for (int n = 0; n < N; ++n) {
      const Vector3d X = model.mesh.nodes.col(n);
      const double error = (fields[k].col(n) - exact(X)).squaredNorm();
      const bool outer = (X.array() == 0.0).any() || (X.array() == 1.0).any();
      (outer ? skin : inside) += error;
      ++(outer ? skin_count : inside_count);
    }
    result[k] = {std::sqrt(inside / inside_count), std::sqrt(skin / skin_count)};
  }
  return result;
}

TEST_CASE(
    "recovered stress converges with a higher order than averaged stress, at the skin above all",
    "[solid][recovery][order]") {
  for (const bool quadratic : {false, true}) {
    const int cells = quadratic ? 4 : 6;
    const auto coarse = errors(cells, quadratic), fine = errors(2 * cells, quadratic);
    const auto order = [&](std::size_t k, double Errors::*where) {
      return std::log2(coarse[k].*where / fine[k].*where);
    };
    INFO((quadratic ? "10-node" : "4-node")
         << "; recovered: skin " << fine[0].skin << " order " << order(0, &Errors::skin)
         << ", inside " << fine[0].inside << " order " << order(0, &Errors::inside)
         << "; averaged: skin " << fine[1].skin << " order " << order(1, &Errors::skin)
         << ", inside " << fine[1].inside << " order " << order(1, &Errors::inside));
    // Second order is what linear patches can have at best; at a skin without neighbours on one
    // side a plain average keeps the first order of the elements.
    CHECK(order(0, &Errors::skin) >= 2 - tolerance(0.4, "two meshes, before the asymptote"));
    CHECK(order(1, &Errors::skin) <= 1 + tolerance(0.2, "two meshes, before the asymptote"));
    CHECK(fine[0].skin < 0.5 * fine[1].skin);  // what makes recovery worth its code
    CHECK(fine[0].inside <= fine[1].inside);   // and nothing is paid for it inside
  }
}

}  // namespace
}  // namespace palpable
