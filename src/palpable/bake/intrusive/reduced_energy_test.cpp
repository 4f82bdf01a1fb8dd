#include "palpable/bake/intrusive/reduced_energy.h"

#include "palpable/bake/solid/equilibrium.h"
#include "tests/support/small_beam.h"
#include "tests/support/test.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::tolerance;

TEST_CASE("the energy of the modes is the body's own, and so are its derivatives",
          "[intrusive][several]") {
  SolidModel model = test::small_beam(8, 3, 2);
  model.groups.push_back({material_from_young("saint-venant-kirchhoff", 2e6, 0.1), {3, 4, 60}});
  const LoadSeries body(model);
  const MatrixXd F =
      energy_modes(body, test::face_loads(model, test::face_nodes(model, 0.05, 0.2), -2.0), 4, 2);
  REQUIRE(F.cols() == 7);
  const QuarticEnergy energy = quartic_energy(model, F);
  QuarticEquilibrium reduced(energy);
  const EquilibriumSolver solver(model);
  VectorXd q(7);
  q << 3e-4, -2e-4, 1e-4, 2e-4, -1e-4, 5e-5, 8e-5;
  const VectorXd u = F * q;
  REQUIRE(u.cwiseAbs().maxCoeff() > 0.005);
  const Eigen::Matrix3Xd field = u.reshaped(3, u.size() / 3);
  CHECK(reduced.evaluate(q) ==
        Approx(solver.stored_energy(field)).epsilon(tolerance(1e-10, "rounding")));
  const VectorXd forces = F.transpose() * solver.internal_force(field).reshaped();
  CHECK((reduced.gradient() - forces).norm() <= tolerance(1e-10, "rounding") * forces.norm());
}

TEST_CASE("two loads at once: within 3 % of a full solve, and stiff without modal derivatives",
          "[intrusive][several]") {
  const SolidModel model = test::small_beam(16, 4, 2);
  const LoadSeries body(model);
  const std::vector<int> above = test::face_nodes(model, 0.05, 0.06),
                         below = test::face_nodes(model, 0.0, 0.30);
  const Eigen::SparseMatrix<double> press = test::face_loads(model, above, -2.0),
                                    back = test::face_loads(model, below, 2.0);
  Eigen::SparseMatrix<double> all(press.rows(), press.cols() + back.cols());
  all.leftCols(press.cols()) = press;
  all.rightCols(back.cols()) = back;
  const EquilibriumSolver newton(model);
  const auto worst_error = [&](const MatrixXd& F) {
    const QuarticEnergy energy = quartic_energy(model, F);
    QuarticEquilibrium reduced(energy);
    double worst = 0;
    for (Index k = 0; k < 6; ++k) {
      const VectorXd f = VectorXd(press.col(press.cols() - 1 - 7 * k)) +
                         (static_cast<double>(k) / 5.0) * VectorXd(back.col(3 * k));
      const PathResult path =
          newton.solve_path(f.reshaped(3, f.size() / 3), std::array<double, 1>{1.0});
      REQUIRE(path.complete);
      const VectorXd truth = path.steps[0].displacement.reshaped();
      VectorXd q = VectorXd::Zero(F.cols());
      REQUIRE(reduced.solve(F.transpose() * f, q).converged);
      worst = std::max(worst, (F * q - truth).norm() / truth.norm());
    }
    return worst;
  };
  const MatrixXd F = energy_modes(body, all, 16, 4);
  CHECK(worst_error(F) <= 0.03);
  CHECK(worst_error(F.leftCols(16)) > 0.1);
}

}  // namespace
}  // namespace palpable
