#include "palpable/common/reduced/quartic_energy.h"

#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <Eigen/Dense>

#include <cmath>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::tolerance;

// W = 1/2 |E(q)|^2 with E = A q + (quadratic in q), which is never negative, like a stored energy.
QuarticEnergy some_energy(Index n, double curved) {
  auto random = test::random_case(static_cast<unsigned>(n));
  std::normal_distribution<double> normal;
  const Index P = n * (n + 1) / 2, m = 2 * P;
  MatrixXd e = MatrixXd::NullaryExpr(m, n, [&] { return normal(random); });
  MatrixXd g = MatrixXd::NullaryExpr(m, P, [&] { return curved * normal(random); });
  const auto gg = [&](Index i, Index j, Index k, Index l) {
    return g.col(pair_row(i, j)).dot(g.col(pair_row(k, l)));
  };
  QuarticEnergy energy{VectorXd(P), MatrixXd(P, n), MatrixXd(P, P)};
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i <= j; ++i) {
      energy.K[pair_row(i, j)] = e.col(i).dot(e.col(j));
      for (Index l = 0; l < n; ++l) {
        energy.C(pair_row(i, j), l) = e.col(i).dot(g.col(pair_row(j, l))) +
                                      e.col(j).dot(g.col(pair_row(i, l))) +
                                      e.col(l).dot(g.col(pair_row(i, j)));
        for (Index k = 0; k <= l; ++k) {
          energy.D(pair_row(i, j), pair_row(k, l)) =
              gg(i, j, k, l) + gg(i, k, j, l) + gg(i, l, j, k);
        }
      }
    }
  }
  return energy;
}

TEST_CASE("all coefficients are restored from the distinct ones", "[reduced][several]") {
  const QuarticEnergy energy = some_energy(5, 0.3);
  const DistinctCoefficients distinct = distinct_coefficients(energy);
  CHECK(distinct.quadratic.size() == 15);
  CHECK(distinct.cubic.size() == 35);
  CHECK(distinct.quartic.size() == 70);
  // 000 001 011 111 002 012 112 022 122 222: the last index runs slowest.
  CHECK(distinct.cubic[5] == energy.C(pair_row(0, 1), 2));
  CHECK(distinct.cubic[8] == energy.C(pair_row(2, 2), 1));
  CHECK(distinct.quartic[69] == energy.D(14, 14));
  const QuarticEnergy again = energy_of(5, distinct);
  CHECK(again.K == energy.K);
  CHECK((again.C - energy.C).norm() <=
        tolerance(1e-14, "three terms summed in any order") * energy.C.norm());
  CHECK((again.D - energy.D).norm() <= tolerance(1e-14, "likewise") * energy.D.norm());
  const DistinctCoefficients once_more = distinct_coefficients(again);
  CHECK(once_more.cubic == distinct.cubic);
  CHECK(once_more.quartic == distinct.quartic);
}

TEST_CASE("the derivatives are those of the energy", "[reduced][several]") {
  const QuarticEnergy energy = some_energy(5, 0.3);
  QuarticEquilibrium body(energy);
  VectorXd q(5);
  q << 0.3, -0.2, 0.5, 0.1, -0.4;
  (void)body.evaluate(q);
  const VectorXd gradient = body.gradient();
  const MatrixXd hessian = body.hessian();
  const double h = 1e-5;
  for (Index i = 0; i < 5; ++i) {
    VectorXd more = q, less = q;
    more[i] += h;
    less[i] -= h;
    const double up = body.evaluate(more);
    const VectorXd gradient_up = body.gradient();
    const double down = body.evaluate(less);
    const VectorXd gradient_down = body.gradient();
    CHECK((up - down) / (2 * h) == Approx(gradient[i]).epsilon(tolerance(1e-7, "h^2 W'''")));
    CHECK(((gradient_up - gradient_down) / (2 * h) - hessian.col(i)).norm() <=
          tolerance(1e-7, "h^2 W''''") * hessian.norm());
  }
  CHECK(body.evaluate(VectorXd::Zero(5)) == 0.0);
}

TEST_CASE("the equilibrium is found from rest and from a distant start, without allocating",
          "[reduced][several]") {
  const QuarticEnergy energy = some_energy(12, 0.5);
  QuarticEquilibrium body(energy);
  VectorXd f(12), q(12);
  for (Index i = 0; i < 12; ++i) f[i] = (i % 3 == 0 ? -40.0 : 25.0);
  for (const double start : {0.0, 0.5, -3.0}) {
    INFO("from " << start);
    q.setConstant(start);
    QuarticEquilibrium::Answer answer;
    CHECK(test::allocations_during([&] { answer = body.solve(f, q); }) == 0);
    CHECK(answer.converged);
    (void)body.evaluate(q);
    CHECK((body.gradient() - f).norm() <= 1e-6 * f.norm());
  }
  CHECK(body.solve(VectorXd::Zero(12), q).converged);
  CHECK(q.isZero(0.0));
  f[3] = std::nan("");
  q.setZero();
  CHECK_FALSE(body.solve(f, q).converged);
}

}  // namespace
}  // namespace palpable
