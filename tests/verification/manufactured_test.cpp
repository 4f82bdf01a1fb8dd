// Manufactured solutions: for a chosen smooth displacement the required body force, traction
// and prescribed displacement are computed, and the solver must reproduce the displacement with
// an error of the theoretical order: L2 norm h^2, H1 norm h for linear tetrahedra; h^3 and h^2
// for 10-node ones.
#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/solid/loads.h"
#include "palpable/bake/solid/selection.h"
#include "palpable/common/geometry/quadrature.h"
#include "palpable/common/geometry/shape_gradients.h"
#include "tests/support/test.h"
#include "tests/verification/record.h"

#include <Eigen/Dense>

#include <array>
#include <cmath>

namespace palpable {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using test::tolerance;

constexpr double kAmplitude = 0.15;  // m, for a body of 1 m: strains of tens of percent

Vector3d exact_displacement(const Vector3d& X) {
  return kAmplitude * Vector3d(std::sin(1.3 * X[0] + 0.5 * X[1]), std::cos(0.9 * X[1] + 1.1 * X[2]),
                               std::sin(1.2 * X[2]) * std::cos(0.7 * X[0]));
}

Matrix3d exact_gradient(const Vector3d& X) {  // H = du/dX
  const double a = 1.3 * X[0] + 0.5 * X[1], b = 0.9 * X[1] + 1.1 * X[2];
  Matrix3d H;
  H << 1.3 * std::cos(a), 0.5 * std::cos(a), 0,   //
      0, -0.9 * std::sin(b), -1.1 * std::sin(b),  //
      -0.7 * std::sin(1.2 * X[2]) * std::sin(0.7 * X[0]), 0,
      1.2 * std::cos(1.2 * X[2]) * std::cos(0.7 * X[0]);
  return kAmplitude * H;
}

Matrix3d exact_stress(const Material& material, const Vector3d& X) {
  return first_piola(material, Matrix3d::Identity() + exact_gradient(X));
}

// -Div P by central differences, whose error of 1e-8 is far below that of the coarsest mesh.
Vector3d body_force(const Material& material, const Vector3d& X) {
  const double h = 1e-4;
  Vector3d b = Vector3d::Zero();
  for (int J = 0; J < 3; ++J) {
    const Vector3d step = h * Vector3d::Unit(J);
    b -= (exact_stress(material, X + step) - exact_stress(material, X - step)).col(J) / (2 * h);
  }
  return b;
}

struct Errors {
  double l2, h1;  // relative to the norm of the exact displacement, and of its gradient
};

// A truncated pyramid whose base has the exact displacement while the other faces carry its
// traction. Its sides rise by 45 degrees: where a held face meets a free one at 90 degrees, the
// dual problem of the proof has a singular edge, and the order in L2 is no longer proved.
Errors solve(const Material& material, int cells, bool quadratic) {
  SolidModel model;
  // Different cell sizes along the axes avoid symmetries of the mesh.
  model.mesh = box_tets({-0.8, -0.6, 0}, {0.8, 0.6, 0.4}, cells + cells / 2, cells, cells / 2);
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    auto X = model.mesh.nodes.col(n);
    X[0] *= 1.0 - X[2] / 0.8;
    X[1] *= 1.0 - X[2] / 0.6;
  }
  if (quadratic) model.mesh = with_edge_nodes(model.mesh);
  model.material = material;
  const TetMesh& mesh = model.mesh;
  model.fixed_nodes = nodes_on_plane(mesh, {0, 0, 0}, {0, 0, 1}, 1e-12);
  model.fixed_displacement.resize(3, static_cast<Eigen::Index>(model.fixed_nodes.size()));
  for (std::size_t k = 0; k < model.fixed_nodes.size(); ++k) {
    model.fixed_displacement.col(static_cast<Eigen::Index>(k)) =
        exact_displacement(mesh.nodes.col(model.fixed_nodes[k]));
  }
  // The whole skin carries its traction; at the base, which is held, it has no effect.
  const Matrix3Xd load =
      body_force_load(mesh, [&](const Vector3d& X) { return body_force(material, X); }) +
      traction_load(mesh, skin_triangles(mesh), [&](const Vector3d& X, const Vector3d& n) {
        return Vector3d(exact_stress(material, X) * n);
      });

  const std::array levels{0.25, 0.5, 0.75, 1.0};  // the chosen one only at level 1
  const PathResult path = EquilibriumSolver(model, {.tolerance = 1e-10}).solve_path(load, levels);
  INFO(path.why_stopped);
  REQUIRE(path.complete);
  const Matrix3Xd& u = path.steps.back().displacement;

  double l2 = 0, l2_exact = 0, h1 = 0, h1_exact = 0;
  const auto add = [&](double weight, const Vector3d& X, const Vector3d& value, const Matrix3d& F) {
    const Vector3d exact = exact_displacement(X);
    const Matrix3d exact_H = exact_gradient(X);
    l2 += weight * (value - exact).squaredNorm();
    l2_exact += weight * exact.squaredNorm();
    h1 += weight * (F - Matrix3d::Identity() - exact_H).squaredNorm();
    h1_exact += weight * exact_H.squaredNorm();
  };
  const Eigen::VectorXd volumes = tet_volumes(mesh);
  for (const auto& [L, weight] : tetrahedron_rule()) {
    const QuadraticShape shape = quadratic_shape(L);
    for (int e = 0; e < mesh.tet_count(); ++e) {
      if (quadratic) {
        const Eigen::Matrix<int, 10, 1> v = quadratic_nodes(mesh, e);
        add(volumes[e] * weight, mesh.nodes(Eigen::all, v) * shape.N, u(Eigen::all, v) * shape.N,
            deformation_gradient(quadratic_gradients(mesh, e, shape).g, v, u));
      } else {
        const Eigen::Vector4i v = mesh.tets.col(e);
        add(volumes[e] * weight, mesh.nodes(Eigen::all, v) * L, u(Eigen::all, v) * L,
            deformation_gradient(shape_gradients(mesh, e).g, v, u));
      }
    }
  }
  return {std::sqrt(l2 / l2_exact), std::sqrt(h1 / h1_exact)};
}

// The orders between the last two meshes, and that in L2 between the first two.
struct Orders {
  double l2, h1, coarse_l2;
};
Orders measure(const std::string& law, bool quadratic, const std::array<int, 3>& meshes) {
  const Material material = material_from_young(law, 1000, 0.3);
  Errors before{};
  Orders orders{};
  for (std::size_t m = 0; m < 3; ++m) {
    INFO(law << ", " << meshes[m] << " cells");
    const Errors now = solve(material, meshes[m], quadratic);
    if (m > 0) {
      const double finer = std::log(double(meshes[m]) / meshes[m - 1]);
      orders = {std::log(before.l2 / now.l2) / finer, std::log(before.h1 / now.h1) / finer,
                orders.l2};
    }
    test::record("manufactured",
                 {{"law", law},
                  {"element", quadratic ? "10-node" : "4-node"},
                  {"cells along an edge", std::to_string(meshes[m])},
                  {"L2 error of u", fmt::format("{:.2e}", now.l2)},
                  {"order", m == 0 ? "" : fmt::format("{:.2f}", orders.l2)},
                  {"L2 error of grad u", fmt::format("{:.2e}", now.h1)},
                  {"order of grad u", m == 0 ? "" : fmt::format("{:.2f}", orders.h1)}});
    before = now;
  }
  return orders;
}

TEST_CASE(
    "a manufactured displacement is found with the orders of linear tetrahedra, under every law",
    "[verification][order][long]") {
  for (const std::string& law : law_names()) {
    INFO(law);
    const Orders orders = measure(law, false, {6, 12, 24});
    CHECK(orders.l2 == Approx(2.0).margin(tolerance(0.15, "still rising, from this mesh on")));
    CHECK(std::abs(orders.l2 - 2.0) < std::abs(orders.coarse_l2 - 2.0));
    CHECK(orders.h1 == Approx(1.0).margin(tolerance(0.05, "the next term, at this mesh size")));
  }
}

TEST_CASE(
    "a manufactured displacement is found with the orders of 10-node tetrahedra, under every law",
    "[verification][order][quadratic][long]") {
  for (const std::string& law : law_names()) {
    INFO(law);
    const Orders orders = measure(law, true, {4, 8, 12});
    CHECK(orders.l2 == Approx(3.0).margin(tolerance(0.1, "the next term, at this mesh size")));
    CHECK(orders.h1 == Approx(2.0).margin(tolerance(0.1, "the next term, at this mesh size")));
  }
}

}  // namespace
}  // namespace palpable
