#include "palpable/bake/solid/stress_together.h"

#include "palpable/bake/solid/stress.h"
#include "palpable/common/base/error.h"
#include "tests/support/small_beam.h"
#include "tests/support/test.h"

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

TEST_CASE("eight states side by side have the stress that each has alone", "[solid][stress]") {
  SolidModel model = test::small_beam(8, 3, 2);
  model.groups.push_back({material_from_young("neo-hookean", 1e6, 0.4), {0, 1, 5, 70}});
  const std::vector<int> nodes{0, 3, 17, 40};
  const StressTogether together(model, nodes);
  auto random = test::random_case(1);
  std::uniform_real_distribution<double> shift(-0.001, 0.001);
  MatrixXd u = MatrixXd::NullaryExpr(model.mesh.nodes.size(), 8, [&] { return shift(random); });
  const MatrixXd stress = together(u);
  REQUIRE(stress.rows() == 24);
  for (Index k = 0; k < 8; ++k) {
    const StressField alone =
        nodal_cauchy_stress(model, Eigen::Matrix3Xd(u.col(k).reshaped(3, u.rows() / 3)));
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const auto expected = alone.col(nodes[n]);
      CHECK((stress.col(k).segment<6>(6 * static_cast<Index>(n)) - expected).norm() <=
            test::tolerance(1e-12, "rounding") * alone.norm());
    }
  }
  u.col(5).setRandom();  // metres
  CHECK_THROWS_AS(together(u), Error);
}

}  // namespace
}  // namespace palpable
