#include "palpable/live/capi/poses.h"

#include "palpable/live/capi/guarded.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <fmt/core.h>

namespace palpable {
namespace {

constexpr double kFarthestPose = 1e4;  // m, largest coordinate of a pose's translation

using RowMajor = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

}  // namespace

Rigid3 pose_of(const double* rows, const char* name) {
  const auto wrong = [&](const char* what) {
    throw Failure(PALPABLE_WRONG_ARGUMENT, fmt::format("{}: {}", name, what));
  };
  if (rows == nullptr) wrong("is null");
  const RowMajor m = Eigen::Map<const RowMajor>(rows);
  if (!m.allFinite()) wrong("holds what is no number");
  if (m.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) wrong("its last row is not 0 0 0 1");
  if (m.topRightCorner<3, 1>().cwiseAbs().maxCoeff() > kFarthestPose)
    wrong("is farther than 10 km");
  const Eigen::Matrix3d R = m.topLeftCorner<3, 3>();
  const double off = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(off <= 1e-3) || R.determinant() < 0) wrong("holds no rotation");
  Rigid3 pose = Rigid3::Identity();
  pose.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
  pose.translation() = m.topRightCorner<3, 1>();
  return pose;
}

void write_pose(const Rigid3& pose, double rows[16]) { Eigen::Map<RowMajor>{rows} = pose.matrix(); }

}  // namespace palpable
