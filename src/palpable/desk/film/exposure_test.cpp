#include "palpable/desk/film/exposure.h"

#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <algorithm>

using namespace palpable;

namespace {

const PinholeCamera kView{1280, 720, 700, 700, 640, 360};
constexpr double kOpen = 0.5;  // frames

/// A frame with an exposure of half a frame. The camera turns by `rate` (rad per frame) and shifts;
/// a ball of 2 cm radius moves by `motion` (m per frame) in the camera frame.
DeskMoment turning(double rate, const Eigen::Vector3d& shift, const Eigen::Vector3d& ball,
                   const Eigen::Vector3d& motion) {
  DeskMoment moment;
  moment.frame = 7;
  moment.rig.exposure = kOpen / kFramesPerSecond;
  moment.camera_from_desk = [=](double frame) {
    return Rigid3(Eigen::Translation3d(shift * (frame - 7)) *
                  Eigen::AngleAxisd(rate * (frame - 7), Eigen::Vector3d::UnitY()));
  };
  moment.movers = [=, pose = moment.camera_from_desk](double frame) {
    HandCapsule capsule;
    const Rigid3 desk_from_own = pose(frame).inverse();
    const Eigen::Vector3d at = ball + motion * (frame - 7);
    capsule.shape = {desk_from_own * at, desk_from_own * (at + Eigen::Vector3d(0, 0.01, 0)), 0.02,
                     0.02};
    return Movers{{capsule}, std::nullopt};
  };
  return moment;
}

Exposure split(const DeskMoment& moment) {
  return split_exposure(kView, Rigid3::Identity(), moment);
}

const Eigen::Vector3d kNo = Eigen::Vector3d::Zero();
const Eigen::Vector3d kAhead(0.01, 0.0, 0.35);

}  // namespace

TEST_CASE("if nothing moves, an exposure has one instant", "[film]") {
  CHECK(split(turning(0, kNo, kAhead, kNo)).is_one_moment());
  DeskMoment moving = turning(0.02, {0.01, 0, 0}, kAhead, {0.02, 0, 0});
  CHECK_FALSE(split(moving).is_one_moment());
  moving.rig.exposure = 0.0;
  CHECK(split(moving).is_one_moment());
  CHECK(split(moving).opens == 7.0);
}

TEST_CASE("movers have a layer for each 4 px that their picture moves within the view", "[film]") {
  const Eigen::Vector3d motion(0.01, 0.0, 0.0);  // 10 px in half a frame at 0.35 m
  const Exposure exposure = split(turning(0, kNo, kAhead, motion));
  CHECK(exposure.layers == 3);
  CHECK(exposure.looks == 1);
  CHECK_FALSE(exposure.turns);
  CHECK(exposure.opens == 6.75);
  CHECK(exposure.closes == 7.25);
  CHECK(split(turning(0, kNo, {0.6, 0, 0.35}, motion)).layers == 1);  // beside the picture
  CHECK(split(turning(0, kNo, {0, 0, -0.35}, motion)).layers == 1);   // behind the eye
  CHECK(split(turning(0, kNo, kAhead, 20 * motion)).layers == 10);    // the upper bound
}

TEST_CASE("a hand that moves along with a turning camera needs no layers for the rotation",
          "[film]") {
  const Exposure exposure = split(turning(0.04, kNo, kAhead, kNo));  // 14 px in half a frame
  CHECK(exposure.references == 1);
  CHECK(exposure.layers == 1);
  CHECK(exposure.looks == 7);
  CHECK(exposure.turns);
}

TEST_CASE("a shifting camera has references, and layers and looks are shared among them",
          "[film]") {
  // 4.4 px of parallax at 0.4 m, 14 px of rotation, 20 px of the ball's motion.
  const Exposure exposure = split(turning(0.04, {0.005, 0, 0}, kAhead, {0.02, 0, 0}));
  CHECK(exposure.references == 3);
  CHECK(exposure.layers == 2);
  CHECK(exposure.looks == 2);
  CHECK(exposure.references * exposure.layers <= kMostLayers);
  CHECK(exposure.references * exposure.layers * exposure.looks <= kMostLooks);
}

TEST_CASE("the numbers of layers and looks are bounded for any motion", "[film]") {
  int most_layers = 0, most_looks = 0;
  for (const double turn : {0.0, 0.01, 0.03, 0.2})
    for (const double shift : {0.0, 0.001, 0.003, 0.006, 0.008, 0.1})
      for (const double motion : {0.0, 0.004, 0.01, 0.02, 0.3}) {
        const Exposure exposure = split(turning(turn, {shift, 0, 0}, kAhead, {motion, 0, 0}));
        const int layers = exposure.references * exposure.layers;
        most_layers = std::max(most_layers, layers);
        most_looks = std::max(most_looks, layers * exposure.looks);
      }
  CHECK(most_layers <= kMostLayers);
  CHECK(most_looks <= kMostLooks);
  CHECK(most_looks > 10);  // otherwise the motions are too small for this test
}

TEST_CASE("if a mover appears or vanishes during the exposure, all are as at the frame's time",
          "[film]") {
  DeskMoment moment = turning(0, kNo, kAhead, {0.01, 0, 0});
  const auto one_ball = moment.movers;
  const auto same_movers = [](const Movers& a, const Movers& b) {
    return std::equal(a.capsules.begin(), a.capsules.end(), b.capsules.begin(), b.capsules.end(),
                      [](const HandCapsule& c, const HandCapsule& d) {
                        return c.shape.a == d.shape.a && c.part == d.part;
                      }) &&
           a.desk_from_cup.has_value() == b.desk_from_cup.has_value();
  };
  // Without a change: the movers at both ends of the exposure.
  const auto [first, last] = movers_between(moment, 6.75, 7.25);
  CHECK(same_movers(first, one_ball(6.75)));
  CHECK(same_movers(last, one_ball(7.25)));
  CHECK_FALSE(same_movers(first, last));
  // A second ball, another part or a cup appears at the time `since`.
  const auto changed = GENERATE(0, 1, 2);
  const double since = GENERATE(6.9, 7.1);
  INFO("change " << changed << " at " << since);
  moment.movers = [=](double frame) {
    Movers movers = one_ball(frame);
    if (frame < since) return movers;
    if (changed == 0) movers.capsules.push_back(movers.capsules[0]);
    if (changed == 1) movers.capsules[0].part = HandPart::kSleeve;
    if (changed == 2) movers.desk_from_cup = Rigid3::Identity();
    return movers;
  };
  const auto [before, after] = movers_between(moment, 6.75, 7.25);
  CHECK(same_movers(before, after));
  CHECK(same_movers(before, moment.movers(7.0)));
  CHECK(split(moment).layers == 1);
}
