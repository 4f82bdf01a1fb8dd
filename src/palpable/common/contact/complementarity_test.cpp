#include "palpable/common/contact/complementarity.h"

#include "palpable/common/base/contract.h"
#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <Eigen/Dense>

#include <random>
#include <vector>

namespace palpable {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::tolerance;

struct Problem {
  MatrixXd W;
  VectorXd q;
};

// A compliance with neighbours that move together, and gaps of both signs.
Problem some_problem(unsigned seed, int m) {
  auto random = test::random_case(seed);
  std::normal_distribution<double> entry;
  const MatrixXd A = MatrixXd::NullaryExpr(m, m, [&] { return entry(random); });
  Problem p;
  p.W = A * A.transpose() + 0.01 * m * MatrixXd::Identity(m, m);
  for (int i = 0; i < m; ++i) {
    for (int j = 0; j < m; ++j) p.W(i, j) += m * std::exp(-0.3 * std::abs(i - j));
  }
  p.q = VectorXd::NullaryExpr(m, [&] { return entry(random) - 0.3; });
  return p;
}

// Tries every subset of points as the pressing ones; exactly one satisfies all conditions.
VectorXd by_trying_all(const Problem& p) {
  const int m = static_cast<int>(p.q.size());
  for (int set = 0; set < (1 << m); ++set) {
    std::vector<int> in;
    for (int i = 0; i < m; ++i) {
      if ((set >> i & 1) != 0) in.push_back(i);
    }
    VectorXd f = VectorXd::Zero(m);
    const VectorXd some = p.W(in, in).ldlt().solve(-p.q(in));
    f(in) = some;
    if (f.minCoeff() >= 0 && (p.W * f + p.q).minCoeff() >= -1e-9) return f;
  }
  FAIL("no set satisfies the conditions");
  return {};
}

// Solves with W row by row, as the solver reads it.
bool solve(Complementarity& solver, const Problem& p, VectorXd& f) {
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> W = p.W;
  return solver.solve({W.data(), static_cast<std::size_t>(W.size())},
                      {p.q.data(), static_cast<std::size_t>(p.q.size())},
                      {f.data(), static_cast<std::size_t>(f.size())});
}

TEST_CASE("the forces are those found by trying every set of pressing points", "[contact][law]") {
  Complementarity solver(12);
  for (unsigned seed = 0; seed < 60; ++seed) {
    INFO("seed " << seed);
    const int m = 1 + static_cast<int>(seed % 11);
    const Problem p = some_problem(seed, m);
    VectorXd f = VectorXd::Zero(m);
    REQUIRE(solve(solver, p, f));
    CHECK((f - by_trying_all(p)).norm() <= tolerance(1e-9, "two factorisations") * (1 + f.norm()));
  }
}

TEST_CASE("for any guess no point pulls, none enters, and none presses at a distance",
          "[contact][law]") {
  Complementarity solver(150);
  for (unsigned seed = 0; seed < 20; ++seed) {
    INFO("seed " << seed);
    const int m = 20 + static_cast<int>(6 * seed);
    const Problem p = some_problem(100 + seed, m);
    VectorXd from_nothing = VectorXd::Zero(m), from_all = VectorXd::Ones(m);
    REQUIRE(solve(solver, p, from_nothing));
    REQUIRE(solve(solver, p, from_all));
    const VectorXd g = p.W * from_all + p.q;
    const double rounding = tolerance(1e-7, "W is conditioned as 1e4") * p.q.norm();
    CHECK(from_all.minCoeff() >= 0);
    CHECK(g.minCoeff() >= -rounding);
    CHECK(std::abs(g.dot(from_all)) <= rounding * from_all.norm());
    CHECK((from_nothing - from_all).norm() <= 1e-7 * from_all.norm());
  }
}

TEST_CASE("a good guess costs one factorisation", "[contact]") {
  const Problem p = some_problem(7, 40);
  Complementarity solver(40);
  VectorXd f = VectorXd::Zero(40);
  REQUIRE(solve(solver, p, f));
  CHECK(solver.steps() > 1);
  REQUIRE(solve(solver, p, f));
  CHECK(solver.steps() == 1);
}

TEST_CASE("problems without points, without a gap below 0, and with a single point are solved",
          "[contact]") {
  Complementarity solver(3);
  VectorXd f(0);
  CHECK(solve(solver, {MatrixXd(0, 0), VectorXd(0)}, f));
  f = VectorXd::Constant(2, 5);
  REQUIRE(solve(solver, {MatrixXd::Identity(2, 2), VectorXd::Constant(2, 0.1)}, f));
  CHECK(f.norm() == 0);
  f = VectorXd::Zero(1);
  REQUIRE(solve(solver, {MatrixXd::Constant(1, 1, 2), VectorXd::Constant(1, -3)}, f));
  CHECK(f[0] == Approx(1.5));
}

TEST_CASE("a compliance that is not positive definite is reported, and the solve ends",
          "[contact]") {
  Complementarity solver(2);
  VectorXd f = VectorXd::Zero(2);
  MatrixXd W(2, 2);
  W << 1, 2, 2, 1;
  CHECK_FALSE(solve(solver, {W, VectorXd::Constant(2, -1)}, f));
  CHECK(f.allFinite());
  W.setConstant(std::numeric_limits<double>::quiet_NaN());
  CHECK_FALSE(solve(solver, {W, VectorXd::Constant(2, -1)}, f));
}

TEST_CASE("a solve allocates nothing, and refuses more points than it has room for",
          "[contact][frame loop]") {
  const Problem p = some_problem(3, 30);
  Complementarity solver(30);
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> W = p.W;
  VectorXd f = VectorXd::Zero(30);
  CHECK(test::allocations_during([&] {
          solver.solve({W.data(), 900}, {p.q.data(), 30}, {f.data(), 30});
        }) == 0);
  VectorXd more = VectorXd::Zero(31);
  CHECK_THROWS_AS(solve(solver, some_problem(3, 31), more), ContractViolation);
}

}  // namespace
}  // namespace palpable
