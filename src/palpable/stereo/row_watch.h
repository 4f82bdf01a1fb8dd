/// @file
/// Are the eyes' rows still aligned? Half a pixel of row error halves the usable pixels of a desk,
/// so matched points are followed across rows in every frame, and a small rotation between the eyes
/// is found from them.
#pragma once

#include "palpable/geometry/camera.h"
#include "palpable/geometry/image.h"
#include "palpable/stereo/stereo_kernels.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace palpable {

struct RowWatchSettings {
  int cell_px = 64;            ///< one point is followed in each cell of so many px
  int least_points = 20;       ///< fewer say nothing
  double limit_px = 0.04;      ///< a median error beyond is corrected if most frames agree on it
  double limit_edge_px = 0.3;  ///< so is a roll that moves the picture's side by this much
};

/// A small rotation of the right eye that brings its rows back: first by `roll` about Z, then by
/// `pitch` about X, radians.
struct EyeTilt {
  double pitch = 0;
  double roll = 0;
  [[nodiscard]] Eigen::Matrix3d rotation() const;
};

/// What one frame's points say, px of the full images.
struct RowError {
  int points = 0;
  /// Median of v_right - v_left: positive where the right image lies lower. NaN with too few
  /// points.
  double median_px = 0;
  /// Fitted to e(u, v) = f (1 + y^2) pitch - f x roll, x = (u - cx) / f, y = (v - cy) / f: the row
  /// error of an eye that is turned by the inverse of this.
  EyeTilt tilt;
};

/// Takes no memory after the first frame.
class RowWatch {
 public:
  /// @param camera  of the full rectified images
  RowWatch(const PinholeCamera& camera, const RowWatchSettings& settings = {});

  /// Follows points from the left to the right image: a step of Lucas and Kanade's method (1981)
  /// in both directions around the matched place, since a row error that was read off along
  /// slanted edges would be a disparity error too.
  /// @param disparity   of the rectified pair, of images `factor` times smaller
  /// @param confidence  of the same size; points are taken where it is high
  const RowError& measure(const GrayImage& left, const GrayImage& right,
                          const Disparities& disparity, const GrayImage& confidence, int factor);

  /// The correction, once the median of the last kFrames frames is beyond a limit; the watch then
  /// begins anew, so the caller has to apply it.
  [[nodiscard]] std::optional<EyeTilt> correction_due();

  [[nodiscard]] const RowError& last() const { return error_; }
  static constexpr std::size_t kFrames = 8;

 private:
  struct Point {
    double u, v, row_error;
  };
  std::optional<Point> follow(const GrayImage& left, const GrayImage& right, int u, int v,
                              double disparity) const;
  // The first of a cell's places that can be followed, if any.
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
