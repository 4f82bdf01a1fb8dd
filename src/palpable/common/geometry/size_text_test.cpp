#include "palpable/common/geometry/size_text.h"

#include "tests/support/test.h"

namespace palpable {
namespace {

TEST_CASE("a size is given in metres or millimetres", "[geometry][size]") {
  CHECK(size_text(Eigen::Vector3d(0.08, 0.0761, 0.06812)) == "80 x 76.1 x 68.1 mm");
  CHECK(size_text(Eigen::Vector3d(80, 76.1, 68.12)) == "80 x 76.1 x 68.1 m");
  CHECK(size_text(Eigen::Vector2d(0.0896, 0.05)) == "89.6 x 50 mm");
  CHECK(size_text(Eigen::Vector2d(0.5, 1)) == "0.5 x 1 m");
}

}  // namespace
}  // namespace palpable
