#include "palpable/common/response/packed_energy.h"

#include "palpable/common/reduced/quartic_energy.h"
#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <Eigen/Core>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::tolerance;

// Any numbers: the energy need not be positive here.
QuarticEnergy some_energy(Index n) {
  auto random = test::random_case(static_cast<unsigned>(n));
  std::normal_distribution<double> normal;
  const auto any = [&] { return normal(random); };
  const Index P = n * (n + 1) / 2;
  DistinctCoefficients distinct;
  distinct.quadratic = VectorXd::NullaryExpr(P, any);
  distinct.cubic = VectorXd::NullaryExpr(distinct_count(n, 3), any);
  distinct.quartic = VectorXd::NullaryExpr(distinct_count(n, 4), any);
  return energy_of(static_cast<int>(n), distinct);
}

TEST_CASE("packed, an energy has the same derivatives to a float's rounding, on every processor",
          "[response]") {
  for (const Index n : {1, 2, 3, 5, 7, 8, 20}) {  // pairs that fill packs and that do not
    INFO(n << " modes");
    const QuarticEnergy energy = some_energy(n);
    QuarticEquilibrium exact(energy);
    PackedEnergy packed(energy), plain(energy, SimdLevel::kPlain);
    auto random = test::random_case(7);
    std::normal_distribution<double> normal;
    const VectorXd q = VectorXd::NullaryExpr(n, [&] { return normal(random); });
    (void)exact.evaluate(q);
    VectorXd gradient, other_gradient;
    MatrixXd hessian, other_hessian;
    packed.evaluate(q, gradient, hessian);
    CHECK((gradient - exact.gradient()).norm() <=
          tolerance(3e-6, "single precision") * exact.gradient().norm());
    CHECK((hessian - exact.hessian()).norm() <=
          tolerance(3e-6, "likewise") * exact.hessian().norm());
    plain.evaluate(q, other_gradient, other_hessian);
    CHECK(gradient == other_gradient);
    CHECK(hessian == other_hessian);
    CHECK(test::allocations_during([&] { packed.evaluate(q, gradient, hessian); }) == 0);
  }
}

}  // namespace
}  // namespace palpable
