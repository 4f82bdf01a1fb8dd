#include "palpable/live/session/hidden_at_start.h"

#include "tests/support/test.h"

#include <cmath>

namespace palpable {
namespace {

const PinholeCamera kCamera{160, 120, 150, 150, 79.5, 59.5};
const DepthNoise kNoise{0, 0, 0.002};

// A sheet of 20 x 20 vertices at 0.5 m, 0.2 m wide: a body's skin.
Eigen::Matrix3Xd sheet() {
  Eigen::Matrix3Xd vertices(3, 400);
  for (int k = 0; k < 400; ++k) {
    vertices.col(k) << 0.01 * (k % 20) - 0.095, 0.01 * (k / 20) - 0.095, 0.5;
  }
  return vertices;
}

// A desk at 0.6 m, and before its left part, up to `until` px, a hand at 0.4 m.
DepthImage seen(int until) {
  DepthImage depth(kCamera.width, kCamera.height, 0.6F);
  for (int y = 0; y < kCamera.height; ++y) {
    for (int x = 0; x < until; ++x) depth(x, y) = 0.4F;
  }
  return depth;
}

TEST_CASE("a part that is hidden from the first frame on is reported until it has been seen",
          "[session][hidden]") {
  const Eigen::Matrix3Xd vertices = sheet();
  HiddenAtStart hidden;
  const auto look = [&](int until) {
    return hidden.look(seen(until), kCamera, kNoise, vertices, Rigid3::Identity());
  };
  CHECK(look(80) == Approx(0.5));
  for (int n = 0; n < 10; ++n) CHECK(look(80) == Approx(0.5));
  CHECK(look(60) < 0.25);  // the hand withdraws
  CHECK(look(80) < 0.25);  // and returns: the part has been seen
  CHECK(look(0) == 0);
  CHECK(look(160) == 0);
  hidden.begin();
  CHECK(look(80) == Approx(0.5));
}

TEST_CASE(
    "a hand that comes later, a hole in the depth and vertices outside the picture hide nothing",
    "[session][hidden]") {
  const Eigen::Matrix3Xd vertices = sheet();
  HiddenAtStart hidden;
  DepthImage nothing(kCamera.width, kCamera.height, std::nanf(""));
  const auto look = [&](const DepthImage& depth, const Rigid3& pose) {
    return hidden.look(depth, kCamera, kNoise, vertices, pose);
  };
  const Rigid3 beside(Eigen::Translation3d(5, 0, 0)), behind(Eigen::Translation3d(0, 0, -2));
  for (int n = 0; n < HiddenAtStart::kFrames; ++n) {
    CHECK(look(nothing, Rigid3::Identity()) == 0);
    CHECK(look(seen(160), beside) == 0);
    CHECK(look(seen(160), behind) == 0);
  }
  CHECK(look(seen(160), Rigid3::Identity()) == 0);
  // A thing that touches the skin or is less than 10 mm in front of it does not hide it.
  HiddenAtStart touched;
  const DepthImage near(kCamera.width, kCamera.height, 0.493F);
  CHECK(touched.look(near, kCamera, kNoise, vertices, Rigid3::Identity()) == 0);
  CHECK(touched.look({}, kCamera, kNoise, {}, Rigid3::Identity()) == 0);
}

}  // namespace
}  // namespace palpable
