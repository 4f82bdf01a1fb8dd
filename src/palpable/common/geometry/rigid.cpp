#include "palpable/common/geometry/rigid.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace palpable {

Rigid3 median_pose(std::span<const Rigid3> poses, double reach) {
  PALPABLE_EXPECT(!poses.empty(), "one pose at least");
  const auto distance = [reach](const Rigid3& a, const Rigid3& b) {
    const double angle = Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
    return (a.translation() - b.translation()).norm() + reach * angle;
  };
  const Rigid3* middle = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const Rigid3& candidate : poses) {
    double sum = 0;
    for (const Rigid3& other : poses) sum += distance(candidate, other);
    if (sum < least) {
      least = sum;
      middle = &candidate;
    }
  }
  PALPABLE_EXPECT(middle != nullptr, "poses are finite");
  std::vector<std::pair<double, const Rigid3*>> near;
  for (const Rigid3& pose : poses) near.emplace_back(distance(*middle, pose), &pose);
  std::stable_sort(near.begin(), near.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  near.resize((near.size() + 1) / 2);
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  Eigen::Vector4d rotation = Eigen::Vector4d::Zero();
  const Eigen::Quaterniond of_middle(middle->linear());
  for (const auto& [unused, pose] : near) {
    translation += pose->translation();
    const Eigen::Quaterniond q(pose->linear());
    // q and -q are the same rotation.
    rotation += of_middle.dot(q) < 0 ? -q.coeffs() : q.coeffs();
  }
  Rigid3 result = Rigid3::Identity();
  result.translation() = translation / static_cast<double>(near.size());
  result.linear() = Eigen::Quaterniond(rotation.normalized()).toRotationMatrix();
  return result;
}

std::optional<Rigid3> pose_nearest(const std::vector<StampedPose>& path, double time,
                                   double within) {
  if (path.empty()) return std::nullopt;
  const auto after = std::lower_bound(path.begin(), path.end(), time,
                                      [](const StampedPose& p, double t) { return p.time < t; });
  const StampedPose* nearest = after == path.end() ? &path.back() : &*after;
  if (after != path.begin() && time - (after - 1)->time < std::abs(nearest->time - time)) {
    nearest = &*(after - 1);
  }
  if (std::abs(nearest->time - time) > within) return std::nullopt;
  return nearest->world_from_camera;
}

}  // namespace palpable
