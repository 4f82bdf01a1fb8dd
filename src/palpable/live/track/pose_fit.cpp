#include "palpable/live/track/pose_fit.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpable {
namespace {

constexpr int kLeastPoints = 4;
constexpr double kNearestInFit = 1e-3;  // m; points with a smaller Z are left out
constexpr double kLargestStep = 1e-7;   // m and rad; a smaller step has converged
constexpr double kLeastPivot = 1e-9;    // ratio to the largest; below, the pose is undetermined

double tukey_weight(double squared_in_limits) {
  if (squared_in_limits >= 1) return 0;
  const double w = 1 - squared_in_limits;
  return w * w;
}

struct Normal {
  Eigen::Matrix<double, 6, 6> H = Eigen::Matrix<double, 6, 6>::Zero();
  Twist b = Twist::Zero();
  int weighted = 0;
};

// Normal equations of one Gauss-Newton step. Residuals beyond `limit` sigma are left out.
Normal normal_equations(const TrackCamera& camera, std::span<const PosePoint> points,
                        const Rigid3& pose, double limit) {
  Normal normal;
  for (const PosePoint& point : points) {
    const Eigen::Vector3d x = pose * point.x_in_world;
    if (x.z() < kNearestInFit) continue;
    const Eigen::Vector3d r = camera.see(x) - point.seen.uvd;
    const double s = limit * point.seen.sigma;
    const double w_uv = tukey_weight(r.head<2>().squaredNorm() / (s * s));
    if (w_uv <= 0) continue;
    ++normal.weighted;
    const Eigen::Matrix<double, 3, 6> J = pose_derivative(camera.derivative(x), x);
    const double uv = point.trust * w_uv / (point.seen.sigma * point.seen.sigma);
    normal.H.noalias() += uv * J.topRows<2>().transpose() * J.topRows<2>();
    normal.b.noalias() += uv * J.topRows<2>().transpose() * r.head<2>();
    if (!point.seen.has_disparity()) continue;
    const double sd = limit * point.seen.sigma_d;
    const double d = point.trust * tukey_weight(r.z() * r.z() / (sd * sd)) /
                     (point.seen.sigma_d * point.seen.sigma_d);
    normal.H.noalias() += d * J.row(2).transpose() * J.row(2);
    normal.b.noalias() += d * J.row(2).transpose() * r.z();
  }
  return normal;
}

}  // namespace

void fit_pose(const TrackCamera& camera, std::span<const PosePoint> points, const Rigid3& start,
              const PoseFitSettings& settings, PoseFit& fit) {
  fit.camera_from_world = start;
  fit.inlier.assign(points.size(), 0);
  fit.inliers = 0;
  fit.rms_sigma = 0;
  fit.solved = false;

  double width = settings.first_width;
  for (int step = 0; step < settings.steps; ++step, width = std::max(1.0, width / 2)) {
    const Normal normal =
        normal_equations(camera, points, fit.camera_from_world, settings.tukey * width);
    if (normal.weighted < kLeastPoints) {
      if (width > 1) continue;
      return;
    }
    const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> factor(normal.H);
    const auto pivots = factor.vectorD().cwiseAbs();
    if (!(pivots.minCoeff() > kLeastPivot * pivots.maxCoeff())) return;
    const Twist change = -factor.solve(normal.b);
    fit.camera_from_world = moved_by(change, fit.camera_from_world);
    fit.solved = true;
    if (width <= 1 && change.cwiseAbs().maxCoeff() < kLargestStep) break;
  }

  double sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d x = fit.camera_from_world * points[i].x_in_world;
    if (x.z() < kNearestInFit) continue;
    const Sighting& seen = points[i].seen;
    const double squared =
        (camera.see(x) - seen.uvd).head<2>().squaredNorm() / (seen.sigma * seen.sigma);
    if (squared > settings.tukey * settings.tukey) continue;
    fit.inlier[i] = 1;
    ++fit.inliers;
    sum += squared;
  }
  if (fit.inliers > 0) fit.rms_sigma = std::sqrt(sum / (2.0 * fit.inliers));
  fit.solved = fit.solved && fit.inliers >= kLeastPoints;
}

}  // namespace palpable
