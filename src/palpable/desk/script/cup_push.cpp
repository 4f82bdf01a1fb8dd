#include "palpable/desk/script/cup_push.h"

#include "palpable/desk/script/things.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace palpable {

using Eigen::Vector3d;

std::optional<CupPush> find_cup_push(const Eigen::Matrix3Xd& points, const Vector3d& direction,
                                     double aside, double bottom) {
  const Vector3d across = Vector3d::UnitZ().cross(direction);
  const Vector3d middle = points.rowwise().mean();
  const Vector3d start = Vector3d(middle.x(), middle.y(), bottom) + aside * across;
  std::optional<CupPush> push;
  double first = 0.0;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Vector3d x = points.col(i);
    const double beside = (x - start).dot(across);
    if (std::abs(beside) >= kCupRadius || x.z() > kCupHeight - kCupWallRadius) continue;
    // A point at the lateral offset `beside` stops the cup half a chord of its circle before the
    // point.
    const double stop =
        (x - start).dot(direction) - std::sqrt(kCupRadius * kCupRadius - beside * beside);
    if (push && stop >= first) continue;
    first = stop;
    push = CupPush{direction, start + stop * direction, x};
  }
  return push;
}

double view_angle_of_push(const CupPush& push, const Vector3d& eye) {
  Vector3d normal = push.touched - push.at_touch;
  normal.z() = 0.0;
  normal.normalize();
  const Vector3d to_eye = (eye - push.touched).normalized();
  return std::acos(std::clamp(normal.dot(to_eye), -1.0, 1.0));
}

}  // namespace palpable
