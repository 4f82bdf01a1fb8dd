#include "palpable/bake/solid/rounded_vector.h"

#include "tests/support/test.h"

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

}  // namespace
}  // namespace palpable
