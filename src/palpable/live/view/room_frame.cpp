#include "palpable/live/view/room_frame.h"

#include "palpable/common/base/contract.h"

#include <cmath>

namespace palpable {

Rigid3 room_from_world(const Eigen::Vector3d& up) {
  PALPABLE_EXPECT(std::abs(up.norm() - 1) < 1e-6, "up is a unit vector");
  const bool lies = std::abs(up.x()) < 0.9;
  const Eigen::Vector3d any = lies ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d right = (any - any.dot(up) * up).normalized();
  Rigid3 result = Rigid3::Identity();
  result.linear() << right.transpose(), up.cross(right).transpose(), up.transpose();
  return result;
}

double heading_of(const Rigid3& room_from_camera) {
  const Eigen::Matrix3d R = room_from_camera.linear();
  const Eigen::Vector3d ahead = R.col(2) - R.col(1);
  return std::atan2(-ahead.x(), ahead.y());
}

}  // namespace palpable
