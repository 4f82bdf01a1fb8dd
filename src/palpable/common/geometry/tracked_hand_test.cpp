#include "palpable/common/geometry/tracked_hand.h"

#include "tests/support/test.h"

#include <cmath>
#include <limits>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3d;
using test::tolerance;

// A flat right hand in the frame of desk/script/hand.h: X towards the fingers, Y to the thumb.
std::vector<Vector3d> flat_hand(HandLayout layout) {
  std::vector<Vector3d> joints;
  if (layout == HandLayout::kOpenXr) joints.emplace_back(0.05, 0, 0);  // palm
  joints.emplace_back(0, 0, 0);
  for (const double way : {0.0, 0.046, 0.080, 0.1035}) {
    joints.emplace_back(0.018 + 0.8 * way, 0.020 + 0.6 * way, -0.008);
  }
  const double sides[] = {0.0235, 0.003, -0.0165, -0.0345};
  for (const double y : sides) {
    if (layout != HandLayout::kMediaPipe) joints.emplace_back(0.012, 0.5 * y, 0);
    for (const double x : {0.09, 0.138, 0.168, 0.1865}) joints.emplace_back(x, y, 0);
  }
  return joints;
}

TEST_CASE("each layout gives its joints' bones, and a mean hand's palm", "[geometry][hands]") {
  for (const HandLayout layout :
       {HandLayout::kOpenXr, HandLayout::kWebXr, HandLayout::kMediaPipe}) {
    INFO(name_of(layout));
    const std::vector<Vector3d> joints = flat_hand(layout);
    REQUIRE(std::ssize(joints) == joint_count(layout));
    const TrackedHand hand = value_or_throw(tracked_hand(layout, HandSide::kRight, joints));
    const auto gap = [&](double x, double y, double z) {
      return signed_distance(hand, Vector3d(x, y, z));
    };
    // Before the tip of the index finger: MediaPipe's tip lies on the skin.
    const double tip = layout == HandLayout::kMediaPipe ? 0.1865 : 0.1865 + 0.0070;
    CHECK(gap(tip, 0.0235, 0) == Approx(0).margin(tolerance(5e-4, "m: the hand's length differs")));
    CHECK(gap(0.138, 0.0235 + 0.0094, 0) == Approx(0).margin(5e-4));
    CHECK(gap(0.05, 0, 0) < -0.010);      // within the palm
    CHECK(gap(0.04, 0.0155, -0.02) < 0);  // the thumb's pad, on the inner side,
    CHECK(gap(0.04, 0.0155, 0.02) > 0);   // not on the back
    CHECK(gap(0.20, 0.1, 0) > 0.05);
    const TrackedHand left = value_or_throw(tracked_hand(layout, HandSide::kLeft, joints));
    CHECK(signed_distance(left, Vector3d(0.04, 0.0155, 0.02)) < 0);
  }
}

TEST_CASE("radii that a tracker gives are those of the fingers", "[geometry][hands]") {
  const std::vector<Vector3d> joints = flat_hand(HandLayout::kWebXr);
  std::vector<double> radii(joints.size(), 0.006);
  radii[9] = 0.005;  // tip of the index finger
  const TrackedHand hand =
      value_or_throw(tracked_hand(HandLayout::kWebXr, HandSide::kRight, joints, radii));
  CHECK(signed_distance(hand, Vector3d(0.1865 + 0.005, 0.0235, 0)) == Approx(0).margin(1e-9));
  CHECK(signed_distance(hand, Vector3d(0.138, 0.0235 + 0.006, 0)) == Approx(0).margin(1e-9));
}

TEST_CASE("a larger hand is thicker", "[geometry][hands]") {
  std::vector<Vector3d> joints = flat_hand(HandLayout::kOpenXr);
  const TrackedHand one =
      value_or_throw(tracked_hand(HandLayout::kOpenXr, HandSide::kRight, joints));
  for (Vector3d& joint : joints) joint *= 1.2;
  const TrackedHand large =
      value_or_throw(tracked_hand(HandLayout::kOpenXr, HandSide::kRight, joints));
  for (std::size_t k = 0; k < one.size(); ++k) {
    CHECK(large[k].ra == Approx(1.2 * one[k].ra));
    CHECK((large[k].b - 1.2 * one[k].b).norm() < 1e-12);
  }
}

TEST_CASE("joints that make no hand are refused", "[geometry][hands][errors]") {
  const auto refusal = [](std::vector<Vector3d> joints, const std::vector<double>& radii = {}) {
    const auto hand = tracked_hand(HandLayout::kOpenXr, HandSide::kRight, joints, radii);
    return hand.ok() ? std::string("none") : hand.problem().message;
  };
  std::vector<Vector3d> joints = flat_hand(HandLayout::kOpenXr);
  CHECK(refusal(joints) == "none");
  for (Vector3d& joint : joints) joint *= 1000;
  CHECK_THAT(refusal(joints), Catch::Contains("in metres"));
  joints = flat_hand(HandLayout::kOpenXr);
  joints[7].y() = std::numeric_limits<double>::quiet_NaN();
  CHECK_THAT(refusal(joints), Catch::Contains("joint 7"));
  std::vector<double> radii(26, 0.01);
  radii[25] = 0;
  CHECK_THAT(refusal(flat_hand(HandLayout::kOpenXr), radii), Catch::Contains("radius of joint 25"));
  CHECK_THAT(refusal(std::vector<Vector3d>(26, Vector3d::Zero())), Catch::Contains("0 m long"));
}

}  // namespace
}  // namespace palpable
