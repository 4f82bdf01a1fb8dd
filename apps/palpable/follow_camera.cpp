#include "apps/palpable/follow_camera.h"

#include "palpable/base/contract.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace palpable::app {
namespace {

constexpr double kElevation = 0.65;  // rad
constexpr double kAside = 0.45;   // rad, over the right shoulder: what the camera sees is beside it
constexpr double kHalfIn = 0.4;   // s
constexpr double kFilled = 0.95;  // of the picture, by an overview

// A rotation that takes `up` to Z and the world's X (or Z) as near as possible to X (or Y).
Rigid3 room_from_world(const Eigen::Vector3d& up) {
  PALPABLE_EXPECT(std::abs(up.norm() - 1) < 1e-6, "up is a unit vector");
  const bool lies = std::abs(up.x()) < 0.9;
  const Eigen::Vector3d any = lies ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d right = (any - any.dot(up) * up).normalized();
  Rigid3 result = Rigid3::Identity();
  result.linear() << right.transpose(), up.cross(right).transpose(), up.transpose();
  return result;
}

// Where a camera heads in the plane of the floor. What lies 45 degrees above its axis counts, so
// that one that looks straight down heads where the top of its picture points.
double heading_of(const Rigid3& room_from_camera) {
  const Eigen::Matrix3d R = room_from_camera.linear();
  const Eigen::Vector3d ahead = R.col(2) - R.col(1);
  return std::atan2(-ahead.x(), ahead.y());
}

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
  orbit_.azimuth = heading_ + kAside + turned_;
}

bool FollowCamera::handle(const WindowEvent& event) {
  bool changed = false;
  switch (event.kind) {
    case WindowEvent::Kind::kPress:
      turning_ = true;
      break;
    case WindowEvent::Kind::kRelease:
      turning_ = false;
      break;
    case WindowEvent::Kind::kMove:
      if (turning_) {
        orbit_.azimuth = turned_;
        orbit_.turn(event.x_px - x_before_, event.y_px - y_before_);
        turned_ = orbit_.azimuth;
        orbit_.azimuth = heading_ + kAside + turned_;
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
        orbit_.azimuth = heading_ + kAside;
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

Rigid3 overview(const Eigen::Matrix3Xf& points, std::span<const Rigid3> path,
                const Eigen::Vector3d& up, const PinholeCamera& camera) {
  PALPABLE_EXPECT(points.cols() > 0 && !path.empty(), "there is something to look at");
  const Rigid3 to_room = room_from_world(up);
  // The mean heading, as a direction.
  Eigen::Vector2d heading = Eigen::Vector2d::Zero();
  for (const Rigid3& pose : path) {
    const double a = heading_of(to_room * pose);
    heading += Eigen::Vector2d(std::cos(a), std::sin(a));
  }
  OrbitCamera orbit;
  orbit.azimuth = std::atan2(heading.y(), heading.x()) + kAside;
  orbit.elevation = 0.6;
  orbit.target = to_room * points.rowwise().mean().cast<double>();

  // Pixels, relative to the picture's middle in shares of its half, that all but 2 % on each side
  // and the whole path keep to; nothing when something lies behind the eye.
  struct Extent {
    Eigen::Vector2d low, high;
    [[nodiscard]] double largest() const {
      return std::max(high.cwiseAbs().maxCoeff(), low.cwiseAbs().maxCoeff());
    }
  };
  const Eigen::Index step = std::max<Eigen::Index>(points.cols() / 20000, 1);
  std::vector<double> across, down;
  const auto extent = [&]() -> std::optional<Extent> {
    const Rigid3 view = orbit.camera_from_body() * to_room;
    across.clear();
    down.clear();
    const auto add = [&](const Eigen::Vector3d& x) {
      if (x.z() < 0.1) return false;
      const Eigen::Vector2d p = camera.project(x);
      across.push_back((p.x() - camera.cx_px) / (0.5 * camera.width));
      down.push_back((p.y() - camera.cy_px) / (0.5 * camera.height));
      return true;
    };
    for (Eigen::Index i = 0; i < points.cols(); i += step) {
      if (!add(view * points.col(i).cast<double>())) return std::nullopt;
    }
    Extent result;
    const std::size_t n = across.size(), few = n / 50;
    for (int axis = 0; axis < 2; ++axis) {
      std::vector<double>& v = axis == 0 ? across : down;
      std::sort(v.begin(), v.end());
      result.low[axis] = v[few];
      result.high[axis] = v[n - 1 - few];
      v.clear();
    }
    for (const Rigid3& pose : path) {
      if (!add(view * Eigen::Vector3d(pose.translation()))) return std::nullopt;
    }
    const auto [left, right] = std::minmax_element(across.begin(), across.end());
    const auto [top, bottom] = std::minmax_element(down.begin(), down.end());
    result.low = result.low.cwiseMin(Eigen::Vector2d(*left, *top));
    result.high = result.high.cwiseMax(Eigen::Vector2d(*right, *bottom));
    return result;
  };
  const auto step_back = [&] {
    double near = 0, far = 100;
    for (int i = 0; i < 30; ++i) {
      orbit.distance = 0.5 * (near + far);
      const auto seen = extent();
      (seen && seen->largest() <= kFilled ? far : near) = orbit.distance;
    }
    orbit.distance = far;
  };
  for (int round = 0; round < 4; ++round) {
    step_back();
    const auto seen = extent();
    if (!seen) break;
    // What is seen into the picture's middle, at the target's depth.
    const Eigen::Vector2d off = 0.5 * (seen->low + seen->high);
    const Rigid3 room_from_view = orbit.camera_from_body().inverse();
    orbit.target += room_from_view.linear() *
                    Eigen::Vector3d(off.x() * 0.5 * camera.width / camera.fx_px,
                                    off.y() * 0.5 * camera.height / camera.fy_px, 0) *
                    orbit.distance;
  }
  step_back();
  return orbit.camera_from_body() * to_room;
}

Eigen::Vector3d up_of_room(const Eigen::Matrix3Xf& normals, const Rigid3& world_from_camera) {
  const auto sum_near = [&](const Eigen::Vector3f& up, float within) {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (Eigen::Index i = 0; i < normals.cols(); ++i) {
      if (normals.col(i).dot(up) > within) sum += normals.col(i);
    }
    return sum;
  };
  Eigen::Vector3f best = -world_from_camera.linear().col(1).cast<float>();
  float most = 0;
  for (int pitch = -60; pitch <= 30; pitch += 10) {  // degrees, up
    const Eigen::AngleAxisd tilt(std::numbers::pi / 180 * pitch, Eigen::Vector3d::UnitX());
    Eigen::Vector3f up =
        (world_from_camera.linear() * (tilt.inverse() * -Eigen::Vector3d::UnitY())).cast<float>();
    Eigen::Vector3f sum;
    for (const float within : {0.94f, 0.966f, 0.985f}) {  // cos of 20, 15 and 10 degrees
      sum = sum_near(up, within);
      if (sum.norm() > 0) up = sum.normalized();
    }
    if (sum.norm() > most) {
      most = sum.norm();
      best = up;
    }
  }
  return best.cast<double>().normalized();
}

}  // namespace palpable::app
