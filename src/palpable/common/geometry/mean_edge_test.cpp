#include "palpable/common/geometry/mean_edge.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <cmath>

namespace palpable {
namespace {

TEST_CASE("the mean edge of a box counts its twelve edges and the diagonals of its faces",
          "[geometry]") {
  const double sum = 4 * (3 + 4 + 12) + 2 * (5 + std::sqrt(153.0) + std::sqrt(160.0));
  CHECK(mean_edge_length(box_surface({0, 0, 0}, {3, 4, 12})) == Approx(sum / 18));
  CHECK_THROWS_AS(mean_edge_length(SurfaceMesh{}), ContractViolation);
}

}  // namespace
}  // namespace palpable
