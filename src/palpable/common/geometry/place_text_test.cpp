#include "palpable/common/geometry/place_text.h"

#include "tests/support/test.h"

#include <limits>

namespace palpable {
namespace {

TEST_CASE("a place has as many digits as tell points of its mesh apart", "[geometry]") {
  CHECK(place_text({0.123456, 40, -1e-5}, 1e-4) == "(0.1235, 40, -1e-05)");
  // A part of 100 mm in the coordinates of a town, in mm.
  CHECK(place_text({4'123'456.75, 12, 0.5}, 0.01) == "(4123456.75, 12, 0.5)");
  CHECK(place_text({4'123'456.8, 12, 0.5}, 0.01) != place_text({4'123'456.75, 12, 0.5}, 0.01));
  CHECK(place_text({12345678, 0, 0}, 0) == "(1.235e+07, 0, 0)");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(place_text({nan, 0, 0}, 0.1) == "(nan, 0, 0)");
  Eigen::Matrix3Xd points(3, 2);
  points << 1e6, 1e6 + 3, 0, 4, 0, 0;
  CHECK(told_apart(points) == 1e-4 * 5.0);
  points(0, 0) = nan;
  CHECK(told_apart(points) == 0.0);
  CHECK(told_apart(Eigen::Matrix3Xd(3, 0)) == 0.0);
}

}  // namespace
}  // namespace palpable
