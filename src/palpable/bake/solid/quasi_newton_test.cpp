#include "palpable/bake/solid/quasi_newton.h"

#include "tests/support/test.h"

#include <Eigen/Dense>

#include <array>
#include <random>

namespace palpable {
namespace {

using Eigen::VectorXd;
using Eigen::VectorXf;
using test::tolerance;

// 65534 steps from the least to the largest, rounded to the nearest.
constexpr double kRounding = 0.5 / 32767.0;

struct Vectors {
  VectorXd v, w;
  RoundedVector rounded_v, rounded_w;
  VectorXf q;  // padded

  // Entries of very different sizes, as forces around a loaded patch have.
  explicit Vectors(Eigen::Index size) : v(size), w(size) {
    auto random = test::random_case(7);
    std::normal_distribution<double> entry;
    const auto draw = [&] { return entry(random) * std::exp(4.0 * entry(random)); };
    v = VectorXd::NullaryExpr(size, draw);
    w = VectorXd::NullaryExpr(size, [&] { return entry(random); });
    rounded_v.assign(v);
    rounded_w.assign(w);
    q = VectorXf::Zero(rounded_v.padded_size());
    q.head(size) = VectorXf::NullaryExpr(size, [&] { return static_cast<float>(entry(random)); });
  }
};

// The values of a rounded vector, entry by entry.
VectorXd widened(const RoundedVector& v, Eigen::Index size) {
  VectorXd wide(size);
  VectorXf unit = VectorXf::Zero(v.padded_size());
  for (Eigen::Index i = 0; i < size; ++i) {
    unit[i] = 1.0F;
    wide[i] = static_cast<double>(dot(SimdLevel::kPlain, v, unit));
    unit[i] = 0.0F;
  }
  return wide;
}

TEST_CASE("each entry is kept to half a step of the largest", "[solid][rounded]") {
  for (const Eigen::Index size : {1, 63, 64, 200}) {
    CAPTURE(size);
    const Vectors a(size);
    const double largest = a.v.cwiseAbs().maxCoeff();
    CHECK((widened(a.rounded_v, size) - a.v).cwiseAbs().maxCoeff() <=
          tolerance(1.001 * kRounding, "half a step, and the step itself a float") * largest);
  }
  RoundedVector zero;
  zero.assign(VectorXd::Zero(5));
  CHECK(widened(zero, 5) == VectorXd::Zero(5));
  CHECK(zero.dot(zero) == 0.0);
}

TEST_CASE("products of rounded vectors, by all instructions", "[solid][rounded]") {
  const Eigen::Index size = 1000;
  const Vectors a(size);
  const VectorXd v = widened(a.rounded_v, size), w = widened(a.rounded_w, size);
  const VectorXd q = a.q.head(size).cast<double>();
  CHECK(std::abs(a.rounded_v.dot(a.rounded_w) - v.dot(w)) <=
        tolerance(1e-6, "floats on the way to the comparison") * v.norm() * w.norm());
  for (const SimdLevel simd : {SimdLevel::kPlain, SimdLevel::kAvx2, SimdLevel::kAvx512}) {
    if (simd > best_simd_level()) continue;
    CAPTURE(static_cast<int>(simd));
    const double rounding = tolerance(1e-5, "1000 sums in single precision");
    CHECK(std::abs(static_cast<double>(dot(simd, a.rounded_v, a.q)) - v.dot(q)) <=
          rounding * v.norm() * q.norm());
    VectorXf sum = a.q;
    const auto along =
        static_cast<double>(add_then_dot(simd, -0.7F, a.rounded_v, sum, a.rounded_w));
    const VectorXd expected = q - 0.7 * v;
    CHECK((sum.head(size).cast<double>() - expected).norm() <= rounding * expected.norm());
    CHECK(sum.tail(a.q.size() - size).isZero(0.0F));
    CHECK(std::abs(along - w.dot(expected)) <= rounding * w.norm() * expected.norm());
  }
}

using Eigen::MatrixXd;

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
