#include "palpable/bake/solid/quasi_newton.h"

#include "tests/support/test.h"

#include <Eigen/Dense>

#include <array>

namespace palpable {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::tolerance;

constexpr int kUnknowns = 30;
constexpr int kCapacity = 3;
constexpr int kDirections = 5;

// A symmetric matrix with eigenvalues 2 .. 31; the "older factor" of these tests is the identity,
// which is wrong along every direction.
struct System {
  MatrixXd K;
  std::array<VectorXd, kDirections> s, Ks;  // s_i . K s_j = 0 for i != j

  System() {
    auto random = test::random_case(3);
    std::normal_distribution<double> entry;
    const MatrixXd any = MatrixXd::NullaryExpr(kUnknowns, kUnknowns, [&] { return entry(random); });
    const MatrixXd Q = Eigen::HouseholderQR<MatrixXd>(any).householderQ();
    K = Q * VectorXd::LinSpaced(kUnknowns, 2, 31).asDiagonal() * Q.transpose();
    for (std::size_t i = 0; i < kDirections; ++i) {
      VectorXd d = VectorXd::NullaryExpr(kUnknowns, [&] { return entry(random); });
      for (std::size_t j = 0; j < i; ++j) d -= d.dot(Ks[j]) / s[j].dot(Ks[j]) * s[j];
      s[i] = d;
      Ks[i] = K * d;
    }
  }
};

// How far the preconditioner is from the inverse along direction i, relative.
double error_along(QuasiNewton& learnt, const System& system, std::size_t i) {
  VectorXd x;
  learnt.solve(system.Ks[i], x, [](const VectorXd& b, VectorXd& y) { y = b; });
  return (x - system.s[i]).norm() / system.s[i].norm();
}

// Later updates keep what was learnt along conjugate directions (Nocedal and Wright, theorem 6.4),
// so the error along a direction shows whether its pair is in use.
void check_known(QuasiNewton& learnt, const System& system, std::array<bool, kDirections> known) {
  for (std::size_t i = 0; i < kDirections; ++i) {
    CAPTURE(i);
    const double error = error_along(learnt, system, i);
    if (known[i]) {
      // Rounding of s and of K s to 16 bits, through three updates, in 30 unknowns whose largest is
      // about three times their mean.
      CHECK(error <= tolerance(1e-3, "pairs are kept in 16 bits"));
    } else {
      CHECK(error >= 1.0);  // x = K s there, at least twice as long as s
    }
  }
}

TEST_CASE("a full preconditioner forgets its oldest pairs", "[solid][sparse]") {
  const System system;
  SECTION("pair by pair") {
    QuasiNewton learnt(kCapacity);
    check_known(learnt, system, {false, false, false, false, false});
    for (std::size_t i = 0; i < 3; ++i) {
      learnt.record(system.s[i], system.Ks[i]);
      learnt.use_recorded();
    }
    check_known(learnt, system, {true, true, true, false, false});
    for (std::size_t i = 3; i < 5; ++i) {
      learnt.record(system.s[i], system.Ks[i]);
      learnt.use_recorded();
    }
    check_known(learnt, system, {false, false, true, true, true});
  }
  SECTION("more recorded in one solve than there is room for") {
    QuasiNewton learnt(kCapacity);
    for (std::size_t i = 0; i < 5; ++i) learnt.record(system.s[i], system.Ks[i]);
    check_known(learnt, system, {false, false, false, false, false});  // not yet in use
    learnt.use_recorded();
    check_known(learnt, system, {false, false, true, true, true});
  }
}

TEST_CASE("a zero right-hand side has a zero answer", "[solid][sparse]") {
  const System system;
  QuasiNewton learnt(kCapacity);
  learnt.record(system.s[0], system.Ks[0]);
  learnt.use_recorded();
  VectorXd x;
  learnt.solve(VectorXd::Zero(kUnknowns), x, [](const VectorXd& b, VectorXd& y) { y = b; });
  CHECK(x == VectorXd::Zero(kUnknowns));
}

}  // namespace
}  // namespace palpable
