/// @file
/// Are the eyes' rows still aligned? Half a pixel of row error halves the pixels of a desk that can
/// be matched. So in every frame matched points are located to a fraction of a row in both images,
/// and a small rotation of the right eye is fitted to their row differences.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/live/stereo/stereo_kernels.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace palpable {

struct RowWatchSettings {
  int cell_px = 64;            ///< one point is followed in each cell of cell_px x cell_px
  int least_points = 20;       ///< with fewer nothing is measured
  double limit_px = 0.04;      ///< a larger median error is corrected if most frames agree on it
  double limit_edge_px = 0.3;  ///< so is a roll that moves the picture's side by more than this
};

/// A small rotation of the right eye that aligns its rows again: first by `roll` about Z, then by
/// `pitch` about X, radians.
struct EyeTilt {
  double pitch = 0;
  double roll = 0;
  [[nodiscard]] Eigen::Matrix3d rotation() const;
};

/// The row error in one frame, px of the full images.
struct RowError {
  int points = 0;
  /// Median of v_right - v_left: positive where the right image lies lower. NaN with too few
  /// points.
  double median_px = 0;
  /// Fitted to e(u, v) = f (1 + y^2) pitch - f x roll, x = (u - cx) / f, y = (v - cy) / f: the row
  /// error of an eye that is turned by the inverse of this.
  EyeTilt tilt;
};

/// Allocates no memory after the first frame.
class RowWatch {
 public:
  /// @param camera  of the full rectified images
  RowWatch(const PinholeCamera& camera, const RowWatchSettings& settings = {});

  /// Follows points from the left to the right image: Lucas and Kanade's method (1981) from the
  /// matched place on, along rows and columns together. Along columns alone, an error of the
  /// disparity would look like a row error wherever edges are slanted.
  /// @param disparity   of the rectified pair, of images `factor` times smaller
  /// @param confidence  of the same size; points are taken where it is high
  const RowError& measure(const GrayImage& left, const GrayImage& right,
                          const Disparities& disparity, const GrayImage& confidence, int factor);

  /// The correction, once the median of the last kFrames frames exceeds a limit. The watch then
  /// starts again from no frames, so the caller has to apply the correction.
  [[nodiscard]] std::optional<EyeTilt> correction_due();

  [[nodiscard]] const RowError& last() const { return error_; }
  static constexpr std::size_t kFrames = 8;

 private:
  struct Point {
    double u, v, row_error;
  };
  std::optional<Point> follow(const GrayImage& left, const GrayImage& right, int u, int v,
                              double disparity) const;
  // Adds the first point of a cell that can be followed, if any can.
  void follow_one_of(const GrayImage& left, const GrayImage& right, const Disparities& disparity,
                     const GrayImage& confidence, int factor, Eigen::Vector2i corner, int cell);
  void fit();

  PinholeCamera camera_;
  RowWatchSettings settings_;
  std::vector<Point> points_;
  std::vector<double> scratch_;
  RowError error_;
  std::array<RowError, kFrames> history_{};
  std::size_t seen_ = 0;  // frames in history_, at most kFrames
  std::size_t next_ = 0;
};

}  // namespace palpable
