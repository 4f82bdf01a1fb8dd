#include "palpable/bake/intrusive/linear_pgd.h"

#include "tests/support/small_beam.h"
#include "tests/support/test.h"

#include <Eigen/Dense>

#include <cmath>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::tolerance;

struct Beam {
  SolidModel model = test::small_beam(16, 4, 2);
  LoadSeries body{model};
  Eigen::SparseMatrix<double> loads =
      test::face_loads(model, test::face_nodes(model, 0.05, 0.05), -1.0);
  VectorXd weights = VectorXd::LinSpaced(loads.cols(), 1.0, 2.0);
};

// Relative errors of truncated SVDs of a matrix with this Gram matrix.
VectorXd tails(const MatrixXd& gram) {
  VectorXd squares = Eigen::SelfAdjointEigenSolver<MatrixXd>(gram).eigenvalues().reverse();
  const double whole = squares.sum();
  VectorXd errors(squares.size());
  double left = whole;
  for (Index m = 0; m < squares.size(); ++m) {
    left -= squares[m];
    errors[m] = std::sqrt(std::max(0.0, left / whole));
  }
  return errors;
}

TEST_CASE("with the adjoint the PGD is the SVD in L2, without it the one in energy",
          "[intrusive]") {
  const Beam beam;
  const MatrixXd f = beam.loads;
  const MatrixXd u = beam.body.linear_response(f);
  const VectorXd w = beam.weights.cwiseSqrt();
  const VectorXd in_l2 =
      tails(w.asDiagonal() * (u.transpose() * beam.body.mass().asDiagonal() * u) * w.asDiagonal());
  const VectorXd in_energy = tails(w.asDiagonal() * (u.transpose() * f) * w.asDiagonal());

  const int modes = 12;
  const LinearPgd adjoint =
      linear_pgd(beam.body, beam.loads, beam.weights, PositionStep::kAdjoint, modes);
  const LinearPgd galerkin =
      linear_pgd(beam.body, beam.loads, beam.weights, PositionStep::kGalerkin, modes);
  const LinearErrors of_adjoint = linear_errors(beam.body, beam.loads, beam.weights, adjoint);
  const LinearErrors of_galerkin = linear_errors(beam.body, beam.loads, beam.weights, galerkin);
  for (Index m = 0; m < modes; ++m) {
    INFO(m + 1 << " modes");
    const double greedy = tolerance(0.05, "alternations end at 1 %, and near pairs mix");
    CHECK(of_adjoint.l2[m] <= in_l2[m] * (1.0 + greedy));
    CHECK(of_adjoint.l2[m] >= in_l2[m] * (1.0 - 1e-6));
    CHECK(of_galerkin.energy[m] <= in_energy[m] * (1.0 + greedy));
    CHECK(of_galerkin.energy[m] >= in_energy[m] * (1.0 - 1e-6));
  }
  // Each is the better one in its own norm. In the energy norm a mode gains hardly anything.
  CHECK(of_adjoint.l2[modes - 1] < of_galerkin.l2[modes - 1]);
  CHECK(of_galerkin.energy[modes - 1] < of_adjoint.energy[modes - 1]);
  CHECK(in_energy[modes - 1] > 10.0 * in_l2[modes - 1]);
}

TEST_CASE("the errors stated are those of the sum of the modes", "[intrusive]") {
  const Beam beam;
  const LinearPgd pgd = linear_pgd(beam.body, beam.loads, beam.weights, PositionStep::kAdjoint, 5);
  const LinearErrors errors = linear_errors(beam.body, beam.loads, beam.weights, pgd);
  const MatrixXd u = beam.body.linear_response(MatrixXd(beam.loads));
  const MatrixXd left = u - pgd.F.leftCols(3) * pgd.G.leftCols(3).transpose();
  const auto norm = [&](const MatrixXd& A) {
    return std::sqrt(
        beam.weights.dot((beam.body.mass().asDiagonal() * A.cwiseAbs2()).colwise().sum()));
  };
  CHECK(errors.l2[2] == Approx(norm(left) / norm(u)).epsilon(1e-6));
}

}  // namespace
}  // namespace palpable
