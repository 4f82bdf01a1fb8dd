/// @file
/// Detects a misalignment of the rows of the two cameras. A row error of half a pixel halves the
/// number of a desk's pixels that can be matched. So in every frame matched points are located to a
/// fraction of a row in both images, and a small rotation of the right camera is fitted to their
/// row differences.
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
  int least_points = 20;       ///< with fewer points nothing is measured
  double limit_px = 0.04;      ///< a larger median error is corrected if most frames agree on it
  double limit_edge_px = 0.3;  ///< a roll is corrected if it moves the picture's sides by more
};

/// A small rotation of the right camera that aligns its rows again: first by `roll` about Z, then
/// by `pitch` about X, radians.
struct EyeTilt {
  double pitch = 0;
  double roll = 0;
  [[nodiscard]] Eigen::Matrix3d rotation() const;
};

/// The row error in one frame, px of the full images.
struct RowError {
  int points = 0;
  /// Median of v_right - v_left: positive where the right image lies lower. NaN if there are too
  /// few points.
  double median_px = 0;
  /// The rotation that corrects the rows. A camera that is turned by its inverse has the row errors
  ///
  ///     e(u, v) = f (1 + y^2) pitch - f x roll,    x = (u - cx) / f,  y = (v - cy) / f      px
  ///
  /// to which it is fitted.
  EyeTilt tilt;
};

/// Allocates no memory after the first frame.
class RowWatch {
 public:
  /// @param camera  of the full rectified images
  RowWatch(const PinholeCamera& camera, const RowWatchSettings& settings = {});

  /// Locates points of the left image in the right image with Lucas and Kanade's method (1981),
  /// starting at the matched position, in x and y together. With y alone, an error of the disparity
  /// would appear as a row error wherever edges are slanted.
  /// @param disparity   of the rectified pair, for images smaller by `factor`
  /// @param confidence  of the same size; only points with high confidence are used
  const RowError& measure(const GrayImage& left, const GrayImage& right,
                          const Disparities& disparity, const GrayImage& confidence, int factor);

  /// The correction, if the median over the last kFrames frames exceeds a limit. The history is
  /// then cleared, so the caller must apply the correction.
  [[nodiscard]] std::optional<EyeTilt> correction_due();

  [[nodiscard]] const RowError& last() const { return error_; }
  static constexpr std::size_t kFrames = 8;

 private:
  struct Point {
    double u, v, row_error;
  };
  std::optional<Point> follow(const GrayImage& left, const GrayImage& right, int u, int v,
                              double disparity) const;
  // Adds the first point of a cell that can be followed, if there is one.
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
