#include "palpable/live/view/room_overview.h"

#include "palpable/common/base/contract.h"
#include "palpable/live/render/orbit_camera.h"
#include "palpable/live/view/room_frame.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

namespace palpable {
namespace {

constexpr double kFilled = 0.95;            // ratio of the room's extent to the picture's
constexpr double kOverviewElevation = 0.6;  // rad above the floor
constexpr double kFarthestEye = 100;        // m from the eye to the middle of the room
constexpr double kNearest = 0.1;            // m, least distance of the eye from any point

// The extent of a room in the picture, relative to the picture's middle, in units of half its size.
struct Extent {
  Eigen::Vector2d low, high;
  [[nodiscard]] double largest() const {
    return std::max(high.cwiseAbs().maxCoeff(), low.cwiseAbs().maxCoeff());
  }
};

// A viewpoint that is moved until it shows a room and the path through it.
class Onlooker {
 public:
  Onlooker(const Eigen::Matrix3Xf& points, std::span<const Rigid3> path, const Eigen::Vector3d& up,
           const PinholeCamera& camera)
      : points_(points), path_(path), camera_(camera), to_room_(room_from_world(up)) {
    // The mean heading, by averaging unit vectors.
    Eigen::Vector2d heading = Eigen::Vector2d::Zero();
    for (const Rigid3& pose : path) {
      const double a = heading_of(to_room_ * pose);
      heading += Eigen::Vector2d(std::cos(a), std::sin(a));
    }
    orbit_.azimuth = std::atan2(heading.y(), heading.x()) + kOverTheShoulder;
    orbit_.elevation = kOverviewElevation;
    orbit_.target = to_room_ * points.rowwise().mean().cast<double>();
  }

  [[nodiscard]] Rigid3 camera_from_world() const { return orbit_.camera_from_body() * to_room_; }

  // Finds the least distance at which everything is in the picture, by bisection.
  void step_back() {
    double near = 0, far = kFarthestEye;
    for (int i = 0; i < 30; ++i) {
      orbit_.distance = 0.5 * (near + far);
      const auto seen = extent();
      (seen && seen->largest() <= kFilled ? far : near) = orbit_.distance;
    }
    orbit_.distance = far;
  }

  // Moves the middle of the room's extent to the picture's middle, at the target's depth. Returns
  // false when something lies behind the eye.
  bool centre() {
    const auto seen = extent();
    if (!seen) return false;
    const Eigen::Vector2d off = 0.5 * (seen->low + seen->high);
    const Rigid3 room_from_view = orbit_.camera_from_body().inverse();
    orbit_.target += room_from_view.linear() *
                     Eigen::Vector3d(off.x() * 0.5 * camera_.width / camera_.fx_px,
                                     off.y() * 0.5 * camera_.height / camera_.fy_px, 0) *
                     orbit_.distance;
    return true;
  }

 private:
  // The extent of all points except 2 % on each side, and of the whole path. Nothing when something
  // lies behind the eye.
  std::optional<Extent> extent() {
    const Rigid3 view = camera_from_world();
    across_.clear();
    down_.clear();
    const Eigen::Index step = std::max<Eigen::Index>(points_.cols() / 20000, 1);
    for (Eigen::Index i = 0; i < points_.cols(); i += step) {
      if (!project(view * points_.col(i).cast<double>())) return std::nullopt;
    }
    Extent result;
    const std::size_t n = across_.size(), few = n / 50;
    for (int axis = 0; axis < 2; ++axis) {
      std::vector<double>& v = axis == 0 ? across_ : down_;
      std::sort(v.begin(), v.end());
      result.low[axis] = v[few];
      result.high[axis] = v[n - 1 - few];
      v.clear();
    }
    for (const Rigid3& pose : path_) {
      if (!project(view * Eigen::Vector3d(pose.translation()))) return std::nullopt;
    }
    const auto [left, right] = std::minmax_element(across_.begin(), across_.end());
    const auto [top, bottom] = std::minmax_element(down_.begin(), down_.end());
    result.low = result.low.cwiseMin(Eigen::Vector2d(*left, *top));
    result.high = result.high.cwiseMax(Eigen::Vector2d(*right, *bottom));
    return result;
  }

  // Appends the projection of a point of the eye's frame. Returns false when it lies behind the
  // eye.
  bool project(const Eigen::Vector3d& x) {
    if (x.z() < kNearest) return false;
    const Eigen::Vector2d p = camera_.project(x);
    across_.push_back((p.x() - camera_.cx_px) / (0.5 * camera_.width));
    down_.push_back((p.y() - camera_.cy_px) / (0.5 * camera_.height));
    return true;
  }

  const Eigen::Matrix3Xf& points_;
  std::span<const Rigid3> path_;
  const PinholeCamera& camera_;
  Rigid3 to_room_;
  OrbitCamera orbit_;
  std::vector<double> across_, down_;
};

// The sum of the normals that are within an angle of a direction. @param cosine  of that angle
Eigen::Vector3f sum_near(const Eigen::Matrix3Xf& normals, const Eigen::Vector3f& up, float cosine) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (Eigen::Index i = 0; i < normals.cols(); ++i) {
    if (normals.col(i).dot(up) > cosine) sum += normals.col(i);
  }
  return sum;
}

}  // namespace

Rigid3 overview(const Eigen::Matrix3Xf& points, std::span<const Rigid3> path,
                const Eigen::Vector3d& up, const PinholeCamera& camera) {
  PALPABLE_EXPECT(points.cols() > 0 && !path.empty(), "there is something to look at");
  Onlooker eye(points, path, up, camera);
  for (int round = 0; round < 4; ++round) {
    eye.step_back();
    if (!eye.centre()) break;
  }
  eye.step_back();
  return eye.camera_from_world();
}

Eigen::Vector3d up_of_room(const Eigen::Matrix3Xf& normals, const Rigid3& world_from_camera) {
  Eigen::Vector3f best = -world_from_camera.linear().col(1).cast<float>();
  float most = 0;
  for (int pitch = -60; pitch <= 30; pitch += 10) {  // degrees, up
    const Eigen::AngleAxisd tilt(std::numbers::pi / 180 * pitch, Eigen::Vector3d::UnitX());
    Eigen::Vector3f up =
        (world_from_camera.linear() * (tilt.inverse() * -Eigen::Vector3d::UnitY())).cast<float>();
    Eigen::Vector3f sum;
    for (const float within : {0.94f, 0.966f, 0.985f}) {  // cos of 20, 15 and 10 degrees
      sum = sum_near(normals, up, within);
      if (sum.norm() > 0) up = sum.normalized();
    }
    if (sum.norm() > most) {
      most = sum.norm();
      best = up;
    }
  }
  return best.cast<double>().normalized();
}

}  // namespace palpable
