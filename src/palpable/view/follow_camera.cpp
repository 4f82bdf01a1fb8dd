#include "palpable/view/follow_camera.h"

#include "palpable/view/room_frame.h"

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

constexpr double kElevation = 0.65;  // rad above the floor
constexpr double kHalfIn = 0.4;      // s until the eye has come half the way to its place

}  // namespace

FollowCamera::FollowCamera(const Eigen::Vector3d& up, double reach)
    : room_from_world_(room_from_world(up)), ahead_(0.5 * reach), distance_(0.8 + reach) {
  orbit_.elevation = kElevation;
  orbit_.distance = distance_;
}

void FollowCamera::follow(const Rigid3& world_from_camera, double time) {
  const Rigid3 room_from_camera = room_from_world_ * world_from_camera;
  const Eigen::Vector3d target = room_from_camera * Eigen::Vector3d(0, 0, ahead_);
  const double heading = heading_of(room_from_camera);
  const double share = time_ ? 1 - std::exp2(-std::max(time - *time_, 0.0) / kHalfIn) : 1.0;
  time_ = time;
  orbit_.target += share * (target - orbit_.target);
  heading_ += share * std::remainder(heading - heading_, 2 * std::acos(-1.0));
  orbit_.azimuth = heading_ + kOverTheShoulder + turned_;
}

bool FollowCamera::handle(const WindowEvent& event) {
  bool changed = false;
  switch (event.kind) {
    case WindowEvent::Kind::kPress:
      if (!button_) button_ = event.button;
      break;
    case WindowEvent::Kind::kRelease:
      if (event.button == button_) button_.reset();
      break;
    case WindowEvent::Kind::kMove:
      if (button_) {
        orbit_.azimuth = turned_;
        orbit_.turn(event.x_px - x_before_, event.y_px - y_before_);
        turned_ = orbit_.azimuth;
        orbit_.azimuth = heading_ + kOverTheShoulder + turned_;
        changed = true;
      }
      break;
    case WindowEvent::Kind::kWheel:
      orbit_.zoom(event.wheel, distance_);
      changed = true;
      break;
    case WindowEvent::Kind::kKey:
      if (event.key == 'R') {
        turned_ = 0;
        orbit_.azimuth = heading_ + kOverTheShoulder;
        orbit_.elevation = kElevation;
        orbit_.distance = distance_;
        changed = true;
      }
      break;
  }
  x_before_ = event.x_px;
  y_before_ = event.y_px;
  return changed;
}

Rigid3 FollowCamera::camera_from_world() const {
  return orbit_.camera_from_body() * room_from_world_;
}

}  // namespace palpable
