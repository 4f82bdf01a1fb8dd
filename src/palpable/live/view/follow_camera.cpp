#include "palpable/live/view/follow_camera.h"

#include "palpable/live/view/room_frame.h"

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

constexpr double kElevation = 0.65;  // rad above the floor
constexpr double kHalfIn = 0.4;      // s in which the eye halves the distance to its usual position

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
  if (const auto way = drag_.follow(event)) {
    orbit_.azimuth = turned_;
    orbit_.turn(way->x_px, way->y_px);
    turned_ = orbit_.azimuth;
    orbit_.azimuth = heading_ + kOverTheShoulder + turned_;
    return true;
  }
  if (event.kind == WindowEvent::Kind::kWheel) {
    orbit_.zoom(event.wheel, distance_);
    return true;
  }
  if (event.kind == WindowEvent::Kind::kKey && event.key == 'R') {
    turned_ = 0;
    orbit_.azimuth = heading_ + kOverTheShoulder;
    orbit_.elevation = kElevation;
    orbit_.distance = distance_;
    return true;
  }
  return false;
}

Rigid3 FollowCamera::camera_from_world() const {
  return orbit_.camera_from_body() * room_from_world_;
}

}  // namespace palpable
