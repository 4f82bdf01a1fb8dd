#include "bench/live/seen_before.h"

#include "tests/support/test.h"

#include <cmath>
#include <numbers>
#include <vector>

namespace palpable::app {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;
using test::tolerance;

constexpr PinholeCamera kEye{640, 360, 350, 350, 319.5, 179.5};
constexpr int kStaves = 24;
constexpr int kFar = 6;  // the stave on the far side, 18 that on the near side

// An upright cup 0.4 m before the camera, of staves, turned about its axis. It has a handle, so
// that it is not the same after one stave's angle.
std::vector<Capsule> cup_turned_by(double angle) {
  const Vector3d middle(0.01, 0.0, 0.4);
  // Rx(90 degrees) turns the cup's Z to the camera's -Y, which is up.
  const Eigen::Matrix3d turn =
      (AngleAxisd(0.5 * std::numbers::pi, Vector3d::UnitX()) * AngleAxisd(angle, Vector3d::UnitZ()))
          .toRotationMatrix();
  const auto at = [&](double x, double y, double z) -> Vector3d {
    return middle + turn * Vector3d(x, y, z);
  };
  std::vector<Capsule> cup;
  for (int i = 0; i < kStaves; ++i) {
    const double phi = 2.0 * std::numbers::pi * i / kStaves;
    const double x = 0.037 * std::cos(phi), y = 0.037 * std::sin(phi);
    cup.push_back({at(x, y, -0.04), at(x, y, 0.04), 0.006, 0.006});
  }
  cup.push_back({at(0.06, 0.0, -0.02), at(0.06, 0.0, 0.02), 0.005, 0.005});
  return cup;
}

// Three bones of a hand that stays where it is.
std::vector<Capsule> resting_hand() {
  return {{{0.06, -0.03, 0.38}, {0.06, 0.01, 0.38}, 0.009, 0.008},
          {{0.06, 0.01, 0.38}, {0.05, 0.03, 0.37}, 0.008, 0.007},
          {{0.05, 0.03, 0.37}, {0.04, 0.04, 0.36}, 0.007, 0.007}};
}

std::vector<Capsule> joined(std::vector<Capsule> first, const std::vector<Capsule>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

TEST_CASE("a rigid thing's motion is that of its capsules, whatever the hand beside it does",
          "[bench][seen_object]") {
  const double angle = 170.0 / 180.0 * std::numbers::pi;
  const std::vector<Capsule> now = joined(resting_hand(), cup_turned_by(angle));
  const std::vector<Capsule> with_hand = joined(resting_hand(), cup_turned_by(0.0));
  const std::vector<Capsule> alone = cup_turned_by(0.0);  // before the hand came
  for (const std::vector<Capsule>* then : {&with_hand, &alone}) {
    const auto motion = motion_of_thing(now, *then, 3 + kFar);
    REQUIRE(motion);
    const std::vector<Capsule> turned = cup_turned_by(angle);
    for (std::size_t i = 0; i < alone.size(); ++i) {
      INFO("capsule " << i);
      CHECK((*motion * alone[i].a - turned[i].a).norm() <=
            tolerance(1e-4, "six ends of 56 do not take part in the motion"));
      CHECK((*motion * alone[i].b - turned[i].b).norm() <= tolerance(1e-4, "the same"));
    }
  }
}

TEST_CASE("a capsule that was not there has no motion", "[bench][seen_object]") {
  const std::vector<Capsule> alone = cup_turned_by(0.0);
  const std::vector<Capsule> now = joined(resting_hand(), alone);
  CHECK_FALSE(motion_of_thing(now, alone, 0).has_value());
  std::vector<Capsule> thicker = now;
  thicker[3].ra += 0.001;
  CHECK_FALSE(motion_of_thing(now, thicker, 3).has_value());
  CHECK(motion_of_thing(now, thicker, 4).has_value());
}

TEST_CASE("the far side of a thing was seen before it was turned, unless something hid it",
          "[bench][seen_object]") {
  const std::vector<Capsule> now = cup_turned_by(std::numbers::pi);
  const std::vector<Capsule> before = cup_turned_by(0.0);
  // After half a turn the stave 18 is on the far side. Its outer side is judged, and its inner one.
  constexpr int kNear = 18;
  const Capsule& stave = now[kNear];
  const Vector3d middle = 0.5 * (stave.a + stave.b);
  REQUIRE(middle.z() > 0.43);
  const auto point = [&](double towards_z) {
    const Vector3d normal(0.0, 0.0, towards_z);
    return ThingPoint{middle + stave.ra * normal, normal, kNear, Side::kBack, false, false};
  };
  const ThingPoints points{point(1.0), point(-1.0)};
  const std::vector<Capsule> hidden =
      joined({{{0.01, -0.05, 0.3}, {0.01, 0.05, 0.3}, 0.02, 0.02}}, before);
  const auto seen_in = [&](const std::vector<std::vector<Capsule>>& frames) {
    const std::vector<std::span<const Capsule>> earlier(frames.begin(), frames.end());
    return seen_before(points, now, earlier, kEye);
  };
  CHECK(seen_in({}) == std::vector<bool>{false, false});
  CHECK(seen_in({now}) == std::vector<bool>{false, false});
  CHECK(seen_in({before}) == std::vector<bool>{true, false});
  CHECK(seen_in({hidden}) == std::vector<bool>{false, false});
  CHECK(seen_in({hidden, before}) == std::vector<bool>{true, false});
}

}  // namespace
}  // namespace palpable::app
