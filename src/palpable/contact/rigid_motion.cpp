#include "palpable/contact/rigid_motion.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

// m: a pixel that shows something farther from the point than this shows something else. Wide at
// first, so that a fast hand is found.
constexpr double kFirstGate = 0.025;
constexpr double kLastGate = 0.005;

// Along the normal from a point to the surface seen now, m; nothing where none is seen.
std::optional<double> to_surface(const Vector3d& point, const Vector3d& normal,
                                 const FrontView& now, double gate) {
  const Vector3d x = now.camera_from_body * point;
  if (!(x.z() > 0.01)) return std::nullopt;
  const double u = now.camera.cx_px + now.camera.fx_px * x.x() / x.z();
  const double v = now.camera.cy_px + now.camera.fy_px * x.y() / x.z();
  if (!(u > -0.5 && v > -0.5 && u < now.camera.width - 0.5 && v < now.camera.height - 0.5)) {
    return std::nullopt;
  }
  const int i = static_cast<int>(std::lround(u)), j = static_cast<int>(std::lround(v));
  const auto Z = static_cast<double>(now.depth(i, j));
  if (!(Z > 0) || (!now.shows.empty() && now.shows(i, j) != kShowsPresser)) return std::nullopt;
  if (std::abs(Z - x.z()) > gate) return std::nullopt;
  // The ray through the point itself, not through the middle of the pixel.
  const Vector3d seen = x * (Z / x.z());
  return normal.dot(now.camera_from_body.linear().transpose() * (seen - x));
}

Rigid3 small_motion(const Vector6d& step, const Vector3d& about) {
  const Vector3d w = step.head<3>();
  Rigid3 motion = Rigid3::Identity();
  const double angle = w.norm();
  if (angle > 0) motion.linear() = Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
  motion.translation() = about + step.tail<3>() - motion.linear() * about;
  return motion;
}

}  // namespace

std::optional<RigidMotion> rigid_motion(std::span<const FrontPoint> before, const FrontView& now,
                                        const Rigid3& guess, const RigidMotionSettings& settings) {
  if (std::ssize(before) < settings.least_points) return std::nullopt;
  Vector3d middle = Vector3d::Zero();
  for (const FrontPoint& p : before) middle += p.point.cast<double>();
  middle /= static_cast<double>(before.size());
  RigidMotion found{guess};
  Rigid3& motion = found.now_from_before;
  Vector6d prior;
  prior << Vector3d::Constant(1 / (settings.turn * settings.turn)),
      Vector3d::Constant(1 / (settings.slide * settings.slide));
  Vector6d gone = Vector6d::Zero();  // from the guess
  for (int round = 0; round < settings.rounds; ++round) {
    const double share = static_cast<double>(round) / std::max(settings.rounds - 1, 1);
    const double gate = kFirstGate * std::pow(kLastGate / kFirstGate, share);
    const Vector3d about = motion * middle;
    Matrix6d A = prior.asDiagonal();
    Vector6d b = -prior.cwiseProduct(gone);
    for (const FrontPoint& p : before) {
      const Vector3d x = motion * p.point.cast<double>();
      const Vector3d n = motion.linear() * p.normal.cast<double>();
      const auto r = to_surface(x, n, now, gate);
      if (!r) continue;
      const double t = *r / gate;
      const double weight = std::pow(1 - t * t, 2) / (settings.sigma * settings.sigma);
      if (!(std::abs(t) < 1)) continue;
      Vector6d J;
      J << (x - about).cross(n), n;
      A += weight * J * J.transpose();
      b += weight * *r * J;
    }
    const Vector6d step = A.ldlt().solve(b);
    if (!step.allFinite()) return std::nullopt;
    motion = small_motion(step, about) * motion;
    gone += step;
  }
  for (const FrontPoint& p : before) {
    const auto r = to_surface(motion * p.point.cast<double>(),
                              motion.linear() * p.normal.cast<double>(), now, kFirstGate);
    ++found.points;
    if (r && std::abs(*r) < settings.agrees) ++found.agreeing;
  }
  if (found.agreeing < settings.least_points ||
      found.agreeing < settings.least_share * found.points) {
    return std::nullopt;
  }
  return found;
}

}  // namespace palpable
