#include "palpable/bake/solid/vibration_modes.h"

#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/solid/selection.h"
#include "tests/support/standing_rubber.h"
#include "tests/support/test.h"

#include <Eigen/Dense>

#include <array>
#include <cmath>
#include <cstring>
#include <numbers>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using test::tolerance;

constexpr double kDensity = 1070;  // kg/m^3

// (3N) u(X) at all nodes.
template <class Field>
VectorXd at_nodes(const TetMesh& mesh, const Field& u) {
  Matrix3Xd all(3, mesh.node_count());
  for (int n = 0; n < mesh.node_count(); ++n) all.col(n) = u(Vector3d(mesh.nodes.col(n)));
  return all.reshaped();
}

double product(const Eigen::SparseMatrix<double>& M, const VectorXd& u, const VectorXd& v) {
  const Eigen::Map<const Matrix3Xd> a(u.data(), 3, M.rows()), b(v.data(), 3, M.rows());
  return (a * M).cwiseProduct(b).sum();
}

// A box of 3 x 2 x 5 cm with nodes inside moved, so that no two elements are alike.
TetMesh uneven_box() {
  TetMesh mesh = box_tets({0, 0, 0}, {0.03, 0.02, 0.05}, 3, 2, 4);
  auto random = test::random_case(3);
  std::uniform_real_distribution<double> shift(-0.002, 0.002);
  for (int n = 0; n < mesh.node_count(); ++n) {
    const Vector3d X = mesh.nodes.col(n);
    const auto at_face = [&](int i, double high) { return X[i] < 1e-9 || X[i] > high - 1e-9; };
    if (at_face(0, 0.03) || at_face(1, 0.02) || at_face(2, 0.05)) continue;
    for (int i = 0; i < 3; ++i) mesh.nodes(i, n) += shift(random);
  }
  return mesh;
}

TEST_CASE("the mass of a mesh is its density times its volume, and turns as a box does",
          "[solid][vibration]") {
  for (const bool quadratic : {false, true}) {
    INFO((quadratic ? "10" : "4") << " nodes");
    const TetMesh mesh = quadratic ? with_edge_nodes(uneven_box()) : uneven_box();
    const Eigen::SparseMatrix<double> M = consistent_mass(mesh, kDensity);
    const double mass = kDensity * 0.03 * 0.02 * 0.05;
    for (int i = 0; i < 3; ++i) {
      const VectorXd moved = at_nodes(mesh, [&](const Vector3d&) { return Vector3d::Unit(i); });
      CHECK(std::abs(product(M, moved, moved) - mass) <=
            tolerance(1e-12, "rounding of some thousand terms") * mass);
    }
    // About the axis Z through the middle: m (a^2 + b^2) / 12.
    const VectorXd turned = at_nodes(mesh, [](const Vector3d& X) {
      return Vector3d::UnitZ().cross(X - Vector3d(0.015, 0.01, 0.025));
    });
    const double inertia = mass * (0.03 * 0.03 + 0.02 * 0.02) / 12;
    CHECK(std::abs(product(M, turned, turned) - inertia) <=
          tolerance(1e-12, "linear fields are exact; rounding") * inertia);
  }
}

TEST_CASE("the mass of 10-node tetrahedra is exact for quadratic fields", "[solid][vibration]") {
  const TetMesh mesh = with_edge_nodes(uneven_box());
  const Eigen::SparseMatrix<double> M = consistent_mass(mesh, kDensity);
  const VectorXd squared =
      at_nodes(mesh, [](const Vector3d& X) { return Vector3d(X[0] * X[2], 0, 0); });
  // int X^2 Z^2 dV = a^3/3 b c^3/3.
  const double exact = kDensity * std::pow(0.03, 3) / 3 * 0.02 * std::pow(0.05, 3) / 3;
  CHECK(std::abs(product(M, squared, squared) - exact) <=
        tolerance(1e-12, "the rule has degree 5, the integrand 4; rounding") * exact);
}

// Checks the equation and the normalisation anew, not as the solver does.
void check_modes(const LoadResponse& body, const VibrationModes& modes) {
  const Eigen::SparseMatrix<double> M = consistent_mass(body.model().mesh, kDensity);
  const Index m = modes.omega.size();
  double worst = 0;
  for (Index k = 0; k < m; ++k) {
    const VectorXd phi = modes.shapes.col(k);
    CHECK(phi.cwiseProduct(VectorXd::Ones(phi.size()) - body.free_mask()).isZero(0));
    const VectorXd K_phi = body.stiffness_times(phi).cwiseProduct(body.free_mask());
    const Eigen::Map<const Matrix3Xd> field(phi.data(), 3, M.rows());
    const Matrix3Xd M_phi = field * M;
    const VectorXd left = K_phi - modes.omega[k] * modes.omega[k] *
                                      VectorXd(M_phi.reshaped()).cwiseProduct(body.free_mask());
    worst = std::max(worst, left.norm() / K_phi.norm());
    for (Index l = 0; l <= k; ++l) {
      CHECK(std::abs(product(M, phi, modes.shapes.col(l)) - (k == l ? 1.0 : 0.0)) <=
            tolerance(1e-9, "the small eigenproblem's rounding"));
    }
    if (k > 0) CHECK(modes.omega[k] >= modes.omega[k - 1]);
    Index largest = 0;
    phi.cwiseAbs().maxCoeff(&largest);
    CHECK(phi[largest] > 0);
  }
  CHECK(worst <= tolerance(1e-6, "what issue 67 asks for"));
  CHECK(std::abs(worst - modes.residual.maxCoeff()) <= 1e-9);
}

SolidModel standing(const TetMesh& mesh) { return test::standing_rubber(mesh); }

// (n x n) K and M of the free components.
struct Dense {
  MatrixXd K, M;
};
Dense dense(const LoadResponse& body) {
  std::vector<Index> free;
  for (Index i = 0; i < body.free_mask().size(); ++i) {
    if (body.free_mask()[i] != 0) free.push_back(i);
  }
  const Eigen::SparseMatrix<double> mass = consistent_mass(body.model().mesh, kDensity);
  const auto n = static_cast<Index>(free.size());
  Dense both{MatrixXd(n, n), MatrixXd::Zero(n, n)};
  for (Index c = 0; c < n; ++c) {
    both.K.col(c) = body.stiffness_times(VectorXd::Unit(body.free_mask().size(), free[c]))(free);
    for (Index r = 0; r < n; ++r) {
      if (free[r] % 3 == free[c] % 3) both.M(r, c) = mass.coeff(free[r] / 3, free[c] / 3);
    }
  }
  return both;
}

TEST_CASE("the lowest modes are those of a dense solver, and none is left out",
          "[solid][vibration]") {
  // Of the square columns most modes come in pairs.
  const TetMesh column = box_tets({0, 0, 0}, {0.02, 0.02, 0.06}, 2, 2, 6);
  for (const auto& [mesh, least] :
       {std::pair{uneven_box(), 25}, std::pair{column, 9},
        std::pair{with_edge_nodes(box_tets({0, 0, 0}, {0.02, 0.02, 0.04}, 1, 1, 2)), 20}}) {
    const SolidModel model = standing(mesh);
    const LoadResponse body(model);
    const VibrationModes modes =
        vibration_modes(body, kDensity, {.least = least, .below = 0, .most = 60});
    CHECK(modes.omega.size() >= least);
    CHECK(modes.omega.size() <= least + 1);  // a pair is not cut
    check_modes(body, modes);
    const Dense both = dense(body);
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> all(both.K, both.M);
    for (Index k = 0; k < modes.omega.size(); ++k) {
      const double exact = std::sqrt(all.eigenvalues()[k]);
      CHECK(std::abs(modes.omega[k] - exact) <=
            tolerance(1e-9, "both at double precision") * exact);
    }
    // All below a bound, which is more than the least.
    const double bound = 1.001 * std::sqrt(all.eigenvalues()[30]);
    const VibrationModes below =
        vibration_modes(body, kDensity, {.least = 2, .below = bound, .most = 60});
    CHECK(below.omega.size() >= (all.eigenvalues().array() < bound * bound).count());
    CHECK(below.omega.size() <= (all.eigenvalues().array() < bound * bound).count() + 1);
    const VibrationModes few =
        vibration_modes(body, kDensity, {.least = 2, .below = bound, .most = 4});
    CHECK(few.omega.size() <= 5);
  }
}

TEST_CASE("a body of few nodes has as many modes as it can move in ways", "[solid][vibration]") {
  const SolidModel model = standing(box_tets({0, 0, 0}, {0.02, 0.02, 0.02}, 1, 1, 1));
  const LoadResponse body(model);
  const VibrationModes modes = vibration_modes(body, kDensity, {.least = 20, .below = 0});
  CHECK(modes.omega.size() == 12);  // four free nodes
  check_modes(body, modes);
}

// A slender beam along X with a square section, held at X = 0; nu = 0, so that the support does not
// stiffen it by holding its section.
SolidModel beam(const std::string& law, double length, double height, int along) {
  SolidModel model;
  model.mesh = with_edge_nodes(box_tets({0, 0, 0}, {length, height, height}, along, 1, 1));
  model.material = material_from_young(law, 1e6, 0.0);
  model.fixed_nodes = nodes_on_plane(model.mesh, {0, 0, 0}, {1, 0, 0}, 1e-12);
  return model;
}

TEST_CASE("a cantilever of 10-node tetrahedra vibrates as the closed forms say",
          "[solid][vibration]") {
  constexpr double kLength = 0.4, kHeight = 0.01, kYoung = 1e6;
  const SolidModel model = beam("saint-venant-kirchhoff", kLength, kHeight, 60);
  const LoadResponse body(model);
  const double wave = std::sqrt(kYoung / kDensity);
  // The first mode along the axis: pi c / (2 L).
  const double axial = 0.5 * std::numbers::pi * wave / kLength;
  const VibrationModes modes =
      vibration_modes(body, kDensity, {.least = 6, .below = 1.02 * axial, .most = 60});
  check_modes(body, modes);
  // Euler and Bernoulli: omega = (b L)^2 sqrt(E I / (rho A)) / L^2 with cosh(b L) cos(b L) = -1.
  // Shear and the turning of sections (Timoshenko; kappa = 5/6) lower it by a share of
  // (b r)^2 (1 + E / (kappa G)) / 2, with r the section's radius of gyration: 0.02 % of the first
  // and 0.6 % of the third.
  const double r = kHeight / std::sqrt(12.0);
  int pair = 0;
  for (const double bL : {1.87510407, 4.69409113, 7.85475744}) {
    const double plain = bL * bL * wave * r / (kLength * kLength);
    const double share = 0.5 * std::pow(bL * r / kLength, 2) * (1 + 2 / (5.0 / 6.0));
    const double expected = plain * (1 - share);
    for (const Index k : {2 * pair, 2 * pair + 1}) {
      CHECK(std::abs(modes.omega[k] - expected) <=
            tolerance(0.01, "60 quadratic elements; the beam theory") * expected);
    }
    ++pair;
  }
  // Bending to both sides has one frequency, and is not cut in two.
  for (const int least : {1, 3}) {
    const VibrationModes few = vibration_modes(body, kDensity, {.least = least, .below = 0});
    CHECK(few.omega.size() == least + 1);
  }
  // One mode moves all nodes along the axis as sin(pi X / 2 L).
  const VectorXd stretched = at_nodes(model.mesh, [&](const Vector3d& X) {
    return Vector3d(std::sin(0.5 * std::numbers::pi * X[0] / kLength), 0, 0);
  });
  const Eigen::SparseMatrix<double> M = consistent_mass(model.mesh, kDensity);
  Index best = 0;
  double most = 0;
  for (Index k = 0; k < modes.omega.size(); ++k) {
    const double part =
        std::pow(product(M, modes.shapes.col(k), stretched), 2) / product(M, stretched, stretched);
    if (part > most) best = k;
    most = std::max(most, part);
  }
  CHECK(most > 0.999);
  CHECK(std::abs(modes.omega[best] - axial) <=
        tolerance(1e-3, "quadratic elements of a 60th") * axial);
}

// omega^2 rho A L^4 / (E I) of the first mode of a column, held at its foot, under a dead load of
// this share of Euler's: the smallest root of the determinant of
//     E I w'''' + P w'' = omega^2 rho A w,   w = w' = 0 at 0,   w'' = 0, E I w''' + P w' = 0 at L
double slowest_of_column(double share) {
  const double p = share * std::pow(0.5 * std::numbers::pi, 2);  // P L^2 / (E I)
  const auto determinant = [&](double lambda) {
    const double root = std::sqrt(p * p / 4 + lambda);
    const double a = std::sqrt(root - p / 2), b = std::sqrt(root + p / 2);
    const double a2 = a * a, b2 = b * b;
    Eigen::Matrix4d conditions;
    conditions.row(0) << 1, 0, 1, 0;
    conditions.row(1) << 0, a, 0, b;
    conditions.row(2) << a2 * std::cosh(a), a2 * std::sinh(a), -b2 * std::cos(b), -b2 * std::sin(b);
    conditions.row(3) << a * (a2 + p) * std::sinh(a), a * (a2 + p) * std::cosh(a),
        b * (b2 - p) * std::sin(b), -b * (b2 - p) * std::cos(b);
    return conditions.determinant();
  };
  double low = 0.05, high = low;
  while (determinant(high) * determinant(low) > 0) high += 0.01;
  low = high - 0.01;
  for (int k = 0; k < 50; ++k) {
    const double middle = 0.5 * (low + high);
    (determinant(middle) * determinant(high) > 0 ? high : low) = middle;
  }
  return low;
}

TEST_CASE("a preload enters the stiffness: a cantilever that is pressed along its axis is slower",
          "[solid][vibration]") {
  constexpr double kLength = 0.4, kHeight = 0.01, kYoung = 1e6;
  const SolidModel model = beam("saint-venant-kirchhoff", kLength, kHeight, 40);
  const double I = std::pow(kHeight, 4) / 12;
  const double buckling = std::pow(0.5 * std::numbers::pi / kLength, 2) * kYoung * I;  // N, Euler
  const double share = 0.4;
  Matrix3Xd force = Matrix3Xd::Zero(3, model.mesh.node_count());
  const std::vector<int> end = nodes_on_plane(model.mesh, {kLength, 0, 0}, {1, 0, 0}, 1e-9);
  for (const int n : end) { force(0, n) = -share * buckling / static_cast<double>(end.size()); }
  const EquilibriumSolver solver(model);
  const PathResult path = solver.solve_path(force, std::array{1.0});
  REQUIRE(path.complete);
  const Preloaded preloaded{force, path.steps[0].displacement};
  const LoadResponse at_rest(model), pressed(model, &preloaded);
  const VibrationSettings settings{.least = 2, .below = 0};
  const VibrationModes modes = vibration_modes(pressed, kDensity, settings);
  check_modes(pressed, modes);
  const double ratio = modes.omega[0] / vibration_modes(at_rest, kDensity, settings).omega[0];
  const double expected = slowest_of_column(share) / slowest_of_column(0);
  CHECK(expected == Approx(0.6185).margin(1e-4));  // somewhat more than 1 - 0.4
  CHECK(std::abs(ratio * ratio - expected) <=
        tolerance(2e-3, "the beam theory at a slenderness of 40") * expected);
}

TEST_CASE("the same body has the same modes to the last bit", "[solid][vibration]") {
  const SolidModel model = standing(uneven_box());
  const LoadResponse first(model), second(model);
  const VibrationModes a = vibration_modes(first, kDensity), b = vibration_modes(second, kDensity);
  REQUIRE(a.shapes.size() == b.shapes.size());
  CHECK(std::memcmp(a.shapes.data(), b.shapes.data(),
                    static_cast<std::size_t>(a.shapes.size()) * sizeof(double)) == 0);
  CHECK(a.omega == b.omega);
}

TEST_CASE("twice the density divides frequencies by the root of two", "[solid][vibration]") {
  const SolidModel model = standing(uneven_box());
  const LoadResponse body(model);
  const VibrationSettings settings{.least = 8, .below = 0};
  const VibrationModes light = vibration_modes(body, kDensity, settings),
                       heavy = vibration_modes(body, 2 * kDensity, settings);
  REQUIRE(light.omega.size() == heavy.omega.size());
  CHECK((heavy.omega * std::sqrt(2.0)).isApprox(light.omega, 1e-10));
  CHECK((heavy.shapes.col(0) * std::sqrt(2.0)).isApprox(light.shapes.col(0), 1e-7));
}

}  // namespace
}  // namespace palpable
