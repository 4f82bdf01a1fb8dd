#include "palpable/synth/exposure.h"

#include "tests/support/test.h"

#include <Eigen/Geometry>

using namespace palpable;

namespace {

const PinholeCamera kView{1280, 720, 700, 700, 640, 360};
constexpr double kOpen = 0.5;  // frames

/// A frame with half a frame of exposure: the camera turns by `rate` (rad a frame) and shifts, a
/// ball of 2 cm moves by `motion` (m a frame) in its frame.
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

TEST_CASE("where nothing moves an exposure is one moment", "[synth]") {
  CHECK(split(turning(0, kNo, kAhead, kNo)).is_one_moment());
  DeskMoment moving = turning(0.02, {0.01, 0, 0}, kAhead, {0.02, 0, 0});
  CHECK_FALSE(split(moving).is_one_moment());
  moving.rig.exposure = 0.0;
  CHECK(split(moving).is_one_moment());
  CHECK(split(moving).opens == 7.0);
}

TEST_CASE("movers have a layer for each 3 px that their picture moves within the view", "[synth]") {
  const Eigen::Vector3d motion(0.01, 0.0, 0.0);  // 10 px in half a frame at 0.35 m
  const Exposure exposure = split(turning(0, kNo, kAhead, motion));
  CHECK(exposure.layers == 4);
  CHECK(exposure.looks == 1);
  CHECK_FALSE(exposure.turns);
  CHECK(exposure.opens == 6.75);
  CHECK(exposure.closes == 7.25);
  CHECK(split(turning(0, kNo, {0.6, 0, 0.35}, motion)).layers == 1);  // beside the picture
  CHECK(split(turning(0, kNo, {0, 0, -0.35}, motion)).layers == 1);   // behind the eye
  CHECK(split(turning(0, kNo, kAhead, 20 * motion)).layers == 10);    // enough
}

TEST_CASE("a hand that goes along with a turning camera needs no layers for the turn", "[synth]") {
  const Exposure exposure = split(turning(0.04, kNo, kAhead, kNo));  // 14 px in half a frame
  CHECK(exposure.references == 1);
  CHECK(exposure.layers == 1);
  CHECK(exposure.looks == 10);
  CHECK(exposure.turns);
}

TEST_CASE("a shifting camera has references, and layers and looks are shared among them",
          "[synth]") {
  // 4.4 px of parallax at 0.4 m, 14 px of turn, 10 px of the ball.
  const Exposure exposure = split(turning(0.04, {0.005, 0, 0}, kAhead, {0.01, 0, 0}));
  CHECK(exposure.references == 3);
  CHECK(exposure.layers == 2);
  CHECK(exposure.looks == 2);
  CHECK(exposure.layers * exposure.looks < kMostLooks);
}
