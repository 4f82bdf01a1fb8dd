#include "palpable/live/stereo/row_watch.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/order_statistics.h"

#include <Eigen/Dense>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace palpable {
namespace {

constexpr int kWindowReach = 5;      // px from the middle of a point's window to its sides
constexpr int kSteps = 6;            // largest number of Gauss-Newton steps
constexpr int kTries = 4;            // positions tried in a cell, across and down
constexpr double kFarthest = 2.5;    // px; a point that moves farther is lost
constexpr double kConverged = 0.03;  // px, length of the last step
constexpr std::uint8_t kSure = 150;  // lowest confidence of a point
// Lower limit of the smaller eigenvalue of the window's gradient matrix, (grey levels / px)^2 per
// pixel, so that only corners are used.
constexpr double kLeastTexture = 6;
constexpr double kLargestResidual = 8;  // grey levels, root mean square
constexpr double kTukey = 0.6;          // px; larger residuals have no weight in the fit

double sample(const GrayImage& image, double u, double v) {
  const int x = static_cast<int>(u);
  const int y = static_cast<int>(v);
  const double s = u - x;
  const double t = v - y;
  const std::uint8_t* a = image.row(y) + x;
  const std::uint8_t* b = image.row(y + 1) + x;
  return (1 - t) * ((1 - s) * a[0] + s * a[1]) + t * ((1 - s) * b[0] + s * b[1]);
}

}  // namespace

Eigen::Matrix3d EyeTilt::rotation() const {
  return (Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitX()) *
          Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()))
      .toRotationMatrix();
}

RowWatch::RowWatch(const PinholeCamera& camera, const RowWatchSettings& settings)
    : camera_(camera), settings_(settings) {
  PALPABLE_EXPECT(settings.cell_px > 0 && settings.limit_px > 0 && settings.limit_edge_px > 0,
                  "cells and limits are positive");
  const std::size_t cells =
      (camera.width / settings.cell_px + 1) * (camera.height / settings.cell_px + 1);
  points_.reserve(cells);
  scratch_.reserve(std::max(cells, kFrames));
}

std::optional<RowWatch::Point> RowWatch::follow(const GrayImage& left, const GrayImage& right,
                                                int u, int v, double disparity) const {
  const double start = u - disparity;
  const int margin = kWindowReach + 4;  // for kFarthest, and a pixel to interpolate
  if (u < margin || v < margin || u >= left.width() - margin || v >= left.height() - margin ||
      start < margin + 1 || start >= left.width() - margin - 2) {
    return std::nullopt;
  }
  constexpr int n = (2 * kWindowReach + 1) * (2 * kWindowReach + 1);
  Eigen::Vector2d mean_g(0, 0);
  Eigen::Matrix2d H = Eigen::Matrix2d::Zero();
  const auto gradient = [&](int x, int y) {
    return Eigen::Vector2d((left(x + 1, y) - left(x - 1, y)) / 2.0,
                           (left(x, y + 1) - left(x, y - 1)) / 2.0);
  };
  for (int y = v - kWindowReach; y <= v + kWindowReach; ++y) {
    for (int x = u - kWindowReach; x <= u + kWindowReach; ++x) {
      const Eigen::Vector2d g = gradient(x, y);
      mean_g += g;
      H += g * g.transpose();
    }
  }
  mean_g /= n;
  H -= n * mean_g * mean_g.transpose();  // the images may differ by a constant
  const double trace = H.trace();
  const double least = trace / 2 - std::sqrt(std::max(trace * trace / 4 - H.determinant(), 0.0));
  if (least < kLeastTexture * n) return std::nullopt;
  const Eigen::Matrix2d inverse = H.inverse();

  const auto residuals = [&](const Eigen::Vector2d& at, Eigen::Vector2d& step) {
    double sum = 0;
    double squares = 0;
    Eigen::Vector2d gr(0, 0);
    for (int y = -kWindowReach; y <= kWindowReach; ++y) {
      for (int x = -kWindowReach; x <= kWindowReach; ++x) {
        const double r = left(u + x, v + y) - sample(right, start + x + at.x(), v + y + at.y());
        sum += r;
        squares += r * r;
        gr += (gradient(u + x, v + y) - mean_g) * r;
      }
    }
    step = inverse * gr;
    return std::sqrt(std::max(squares / n - (sum / n) * (sum / n), 0.0));
  };
  Eigen::Vector2d at(0, 0);
  Eigen::Vector2d step;
  double rms = 0;
  for (int i = 0; i < kSteps; ++i) {
    rms = residuals(at, step);
    at += step;
    if (!(at.cwiseAbs().maxCoeff() < kFarthest)) return std::nullopt;
    if (step.norm() < kConverged) break;
  }
  if (step.norm() > kConverged || rms > kLargestResidual) return std::nullopt;
  return Point{static_cast<double>(u), static_cast<double>(v), at.y()};
}

void RowWatch::fit() {
  // Iteratively reweighted least squares with Tukey's weights, starting at the median.
  double pitch = error_.median_px / camera_.fy_px;
  double roll = 0;
  for (int i = 0; i < 8; ++i) {
    Eigen::Matrix2d A = Eigen::Matrix2d::Zero();
    Eigen::Vector2d b = Eigen::Vector2d::Zero();
    for (const Point& point : points_) {
      const double x = (point.u - camera_.cx_px) / camera_.fx_px;
      const double y = (point.v - camera_.cy_px) / camera_.fy_px;
      const Eigen::Vector2d row(camera_.fy_px * (1 + y * y), -camera_.fy_px * x);
      const double off = (point.row_error - row.x() * pitch - row.y() * roll) / kTukey;
      if (std::abs(off) >= 1) continue;
      const double w = (1 - off * off) * (1 - off * off);
      A += w * row * row.transpose();
      b += w * point.row_error * row;
    }
    // Regularisation: points on one side of the picture only cannot separate roll from pitch.
    A(1, 1) += 1e-2 * A(0, 0);
    const Eigen::Vector2d found = A.ldlt().solve(b);
    if (!found.allFinite()) break;
    pitch = found.x();
    roll = found.y();
  }
  error_.tilt = {pitch, roll};
}

void RowWatch::follow_one_of(const GrayImage& left, const GrayImage& right,
                             const Disparities& disparity, const GrayImage& confidence, int factor,
                             Eigen::Vector2i corner, int cell) {
  for (int i = 0; i < kTries * kTries; ++i) {
    const int x = corner.x() + (2 * (i % kTries) + 1) * cell / (2 * kTries);
    const int y = corner.y() + (2 * (i / kTries) + 1) * cell / (2 * kTries);
    if (x >= disparity.width() || y >= disparity.height()) continue;
    const std::int16_t d = disparity(x, y);
    if (!is_measured(d) || confidence(x, y) < kSure) continue;
    const auto point = follow(left, right, factor * x, factor * y,
                              static_cast<double>(factor) * d / kDisparitySteps);
    if (!point) continue;
    points_.push_back(*point);
    return;
  }
}

const RowError& RowWatch::measure(const GrayImage& left, const GrayImage& right,
                                  const Disparities& disparity, const GrayImage& confidence,
                                  int factor) {
  PALPABLE_EXPECT(left.width() == camera_.width && left.height() == camera_.height &&
                      right.width() == left.width() && right.height() == left.height() &&
                      disparity.width() == left.width() / factor &&
                      disparity.height() == left.height() / factor,
                  "images and disparities fit the camera");
  points_.clear();
  const int cell = std::max(settings_.cell_px / factor, kTries);
  for (int y = 0; y < disparity.height(); y += cell) {
    for (int x = 0; x < disparity.width(); x += cell) {
      follow_one_of(left, right, disparity, confidence, factor, {x, y}, cell);
    }
  }
  error_ = {static_cast<int>(points_.size()), std::numeric_limits<double>::quiet_NaN(), {}};
  if (error_.points < settings_.least_points) return error_;
  scratch_.clear();
  for (const Point& point : points_) scratch_.push_back(point.row_error);
  error_.median_px = upper_median(scratch_);
  fit();
  history_[next_] = error_;
  next_ = (next_ + 1) % kFrames;
  seen_ = std::min(seen_ + 1, kFrames);
  return error_;
}

std::optional<EyeTilt> RowWatch::correction_due() {
  if (seen_ < kFrames) return std::nullopt;
  const auto median_over_frames = [this](auto value) {
    scratch_.clear();
    for (const RowError& error : history_) scratch_.push_back(value(error));
    return upper_median(scratch_);
  };
  const double median = median_over_frames([](const RowError& e) { return e.median_px; });
  const EyeTilt tilt{median_over_frames([](const RowError& e) { return e.tilt.pitch; }),
                     median_over_frames([](const RowError& e) { return e.tilt.roll; })};
  // With few points the median scatters. So 75 % of the frames must have an error of the same sign.
  const auto agreeing = std::count_if(history_.begin(), history_.end(), [&](const RowError& e) {
    return e.median_px * median > 0 && std::abs(e.median_px) > settings_.limit_px / 2;
  });
  const bool off = std::abs(median) > settings_.limit_px &&
                   4 * static_cast<std::size_t>(agreeing) >= 3 * kFrames;
  const double edge = std::abs(tilt.roll) * camera_.width / 2.0;
  if (!off && edge <= settings_.limit_edge_px) return std::nullopt;
  seen_ = 0;
  return tilt;
}

}  // namespace palpable
