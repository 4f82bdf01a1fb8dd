// Manufactured solutions: a smooth displacement is chosen, the body force, traction and prescribed
// displacement that it needs are computed from it, and the solver must find it again, with an error
// that falls as theory says: L2 norm by h^2, H1 norm by h for linear tetrahedra.
#include "palpable/solid/equilibrium.h"
#include "palpable/solid/quadrature.h"
#include "palpable/solid/shape_gradients.h"
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

constexpr double kAmplitude = 0.15;  // m on a body of 1 m: strains of tens of percent

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

// -Div P, by central differences: their error, 1e-8, is far below that of the coarsest mesh.
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

// A pyramid without its top, whose base is moved as the exact displacement says while the other
// faces bear its traction. Its sides rise by 45 degrees: where a held face meets a free one at 90,
// even a problem with a smooth solution converges more slowly in L2 (we measured 1.72 on a cube),
// because the dual problem of the proof has a singular edge there.
Errors solve(const Material& material, int cells) {
  SolidModel model;
  // Different cell sizes along the axes, so that no symmetry of the mesh helps.
  model.mesh = box_tets({-0.8, -0.6, 0}, {0.8, 0.6, 0.4}, cells + cells / 2, cells, cells / 2);
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    auto X = model.mesh.nodes.col(n);
    X[0] *= 1.0 - X[2] / 0.8;
    X[1] *= 1.0 - X[2] / 0.6;
  }
  model.material = material;
  const Matrix3Xd& X = model.mesh.nodes;
  const int N = model.mesh.node_count();
  for (int n = 0; n < N; ++n) {
    if (X(2, n) == 0.0) model.fixed_nodes.push_back(n);
  }
  model.fixed_displacement.resize(3, static_cast<Eigen::Index>(model.fixed_nodes.size()));
  for (std::size_t k = 0; k < model.fixed_nodes.size(); ++k) {
    model.fixed_displacement.col(static_cast<Eigen::Index>(k)) =
        exact_displacement(X.col(model.fixed_nodes[k]));
  }

  Matrix3Xd load = Matrix3Xd::Zero(3, N);
  const Eigen::VectorXd volumes = tet_volumes(model.mesh);
  for (int e = 0; e < model.mesh.tet_count(); ++e) {
    const Eigen::Vector4i v = model.mesh.tets.col(e);
    for (const auto& [barycentric, weight] : tetrahedron_rule()) {
      const Vector3d at = X(Eigen::all, v) * barycentric;
      load(Eigen::all, v) +=
          volumes[e] * weight * body_force(material, at) * barycentric.transpose();
    }
  }
  const Boundary skin = boundary_of(model.mesh);
  for (Eigen::Index t = 0; t < skin.surface.triangles.cols(); ++t) {
    Eigen::Vector3i v = skin.surface.triangles.col(t);
    for (int& k : v) k = skin.node_of_vertex[static_cast<std::size_t>(k)];
    if ((X(2, v).array() == 0.0).all()) continue;
    const Vector3d area =
        0.5 * Vector3d(X.col(v[1]) - X.col(v[0])).cross(Vector3d(X.col(v[2]) - X.col(v[0])));
    for (const auto& [barycentric, weight] : triangle_rule()) {
      const Vector3d at = X(Eigen::all, v) * barycentric.head<3>();
      load(Eigen::all, v) +=
          weight * exact_stress(material, at) * area * barycentric.head<3>().transpose();
    }
  }

  const std::array levels{0.25, 0.5, 0.75, 1.0};  // in between the solution is another one
  const PathResult path = EquilibriumSolver(model, {.tolerance = 1e-10}).solve_path(load, levels);
  INFO(path.why_stopped);
  REQUIRE(path.complete);
  const Matrix3Xd& u = path.steps.back().displacement;

  double l2 = 0, l2_exact = 0, h1 = 0, h1_exact = 0;
  for (int e = 0; e < model.mesh.tet_count(); ++e) {
    const Eigen::Vector4i v = model.mesh.tets.col(e);
    const Matrix3d H =
        deformation_gradient(shape_gradients(model.mesh, e).g, v, u) - Matrix3d::Identity();
    for (const auto& [barycentric, weight] : tetrahedron_rule()) {
      const Vector3d at = X(Eigen::all, v) * barycentric;
      const Vector3d exact = exact_displacement(at);
      const Matrix3d exact_H = exact_gradient(at);
      l2 += volumes[e] * weight * (u(Eigen::all, v) * barycentric - exact).squaredNorm();
      l2_exact += volumes[e] * weight * exact.squaredNorm();
      h1 += volumes[e] * weight * (H - exact_H).squaredNorm();
      h1_exact += volumes[e] * weight * exact_H.squaredNorm();
    }
  }
  return {std::sqrt(l2 / l2_exact), std::sqrt(h1 / h1_exact)};
}

TEST_CASE(
    "a manufactured displacement is found with the orders of linear tetrahedra, under every law",
    "[verification][order][long]") {
  for (const std::string& law : law_names()) {
    const Material material = material_from_young(law, 1000, 0.3);
    Errors before{};
    double coarse_l2_order = 0;
    for (const int cells : {6, 12, 24}) {
      INFO(law << ", " << cells << " cells");
      const Errors now = solve(material, cells);
      const double l2_order = std::log2(before.l2 / now.l2),
                   h1_order = std::log2(before.h1 / now.h1);
      test::record("manufactured",
                   {{"law", law},
                    {"element", "4-node"},
                    {"cells along an edge", std::to_string(cells)},
                    {"L2 error of u", fmt::format("{:.2e}", now.l2)},
                    {"order", cells == 6 ? "" : fmt::format("{:.2f}", l2_order)},
                    {"L2 error of grad u", fmt::format("{:.2e}", now.h1)},
                    {"order of grad u", cells == 6 ? "" : fmt::format("{:.2f}", h1_order)}});
      if (cells == 12) coarse_l2_order = l2_order;
      if (cells == 24) {
        CHECK(l2_order == Approx(2.0).margin(tolerance(0.15, "still rising, from this mesh on")));
        CHECK(std::abs(l2_order - 2.0) < std::abs(coarse_l2_order - 2.0));
        CHECK(h1_order == Approx(1.0).margin(tolerance(0.05, "the next term, at this mesh size")));
      }
      before = now;
    }
  }
}

}  // namespace
}  // namespace palpable
