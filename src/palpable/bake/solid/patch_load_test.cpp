#include "palpable/bake/solid/patch_load.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "tests/support/test.h"

#include <array>
#include <vector>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using test::tolerance;

TEST_CASE("a patch load is one newton in total along its direction, shared by weight",
          "[solid][load]") {
  const std::array nodes{4, 1, 2};
  const std::array weights{1.0, 2.0, 5.0};
  const Eigen::Vector3d direction(0, 3, -4);
  const Eigen::Matrix3Xd f = patch_force(6, nodes, weights, direction);
  REQUIRE(f.cols() == 6);
  CHECK((f.rowwise().sum() - direction / 5.0).norm() <= tolerance(1e-15, "three roundings"));
  CHECK((f.col(2) - direction / 8.0).norm() <= tolerance(1e-15, "one division"));
  CHECK(f.col(0).norm() + f.col(3).norm() + f.col(5).norm() == 0.0);
}

TEST_CASE("a patch that cannot carry a load is refused", "[solid][load][errors]") {
  const std::vector<int> nodes{0, 1};
  const std::vector<double> weights{1, 1}, zeros{0, 0}, negative{1, -1};
  const Eigen::Vector3d up(0, 0, 1);
  CHECK_THROWS_WITH(patch_force(3, {}, {}, up), Contains("empty"));
  CHECK_THROWS_WITH(patch_force(1, nodes, weights, up), Contains("node 1"));
  CHECK_THROWS_WITH(patch_force(3, nodes, zeros, up), Contains("all zero"));
  CHECK_THROWS_WITH(patch_force(3, nodes, negative, up), Contains("-1"));
  CHECK_THROWS_WITH(patch_force(3, nodes, weights, Eigen::Vector3d::Zero()), Contains("direction"));
  CHECK_THROWS_AS(patch_force(3, nodes, std::vector<double>{1}, up), ContractViolation);
}

}  // namespace
}  // namespace palpable
