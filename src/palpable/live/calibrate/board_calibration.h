/// @file
/// The calibration of a rig from pictures of a chessboard (paper Sec. 3.3: intrinsics, distortion
/// and the pose between the eyes are known beforehand), and the pose of a chessboard.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/live/calibrate/calibration_file.h"

#include <Eigen/Core>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace palpable {

/// The size of a board in inner corners, where four squares meet: an ordinary chessboard has 7 x 7.
struct BoardPattern {
  int columns = 9;
  int rows = 6;
  double square = 0.025;  ///< m, side of a square; the calibration's lengths are in proportion
};

/// The corners of the board in both images of one frame, px of the raw images; corner (row, column)
/// has the index row * columns + column.
struct BoardView {
  int number = 0;  ///< of the frame
  std::vector<Eigen::Vector2d> left;
  std::vector<Eigen::Vector2d> right;
};

/// Finds the corners, to a few hundredths of a pixel in a sharp picture; nothing unless both images
/// show the whole board. Takes 0.1 s or more.
[[nodiscard]] std::optional<BoardView> find_board(const ColorImage& left, const ColorImage& right,
                                                  const BoardPattern& pattern);

/// The pose camera_from_board of the board in one picture. The board's origin is in the middle of
/// its corners, Z points out of the board towards the camera, and X along the side that points most
/// to the right in the picture, so the pose does not depend on which corner was found first. The
/// pose minimises the reprojection error of all corners (Collins and Bartoli 2014, IPPE, then
/// cv::solvePnPRefineLM).
///
/// @param camera  of the picture, which has no distortion
/// @return nothing unless the whole board is visible
[[nodiscard]] std::optional<Rigid3> find_board_pose(const ColorImage& image,
                                                    const PinholeCamera& camera,
                                                    const BoardPattern& pattern);

/// Mean distance between the corners of two views in px, over both images. A second view that
/// hardly differs from the first adds nothing to a calibration.
[[nodiscard]] double difference_px(const BoardView& a, const BoardView& b);

/// Limits beyond which a calibration is refused.
struct BoardLimits {
  /// Accept the result, with BoardCalibration::weakness, although the boards are too few or not
  /// tilted enough, or the focal length is too uncertain. The other limits still apply.
  bool accept_weak = false;
  int fewest_views = 6;
  /// Smallest angle between the two most different boards, rad. If all boards are parallel to the
  /// image, focal length and distance cannot be separated.
  double least_tilt = 0.26;
  double largest_reprojection_px = 1.0;  ///< rms
  /// rms. Stereo matching searches along one row, and degrades with row errors above half a pixel.
  double largest_row_error_px = 0.5;
  double largest_focal_sigma = 0.01;  ///< ratio to the focal length
};

struct BoardCalibration {
  StereoCalibration calibration;
  double reprojection_px = 0;            ///< rms over all corners of both eyes
  std::vector<double> reprojections_px;  ///< the same for each view
  double row_error_px = 0;  ///< rms of y_left - y_right of the corners after rectification
  double focal_sigma = 0;   ///< standard deviation of the left fx, ratio to fx
  /// The reason for which it would be refused without accept_weak, and the resulting uncertainty of
  /// the focal length; empty if there is none.
  std::string weakness;
  double tilt = 0;     ///< rad between the two most different boards
  double covered = 0;  ///< share of the left image inside the convex hull of all corners
};

/// Calibrates each camera by Zhang's method (cv::calibrateCamera with k1 k2 p1 p2), then both and
/// the pose between them together (cv::stereoCalibrate).
///
/// Returns a problem, without a file's name, if there is no calibration or it cannot be trusted:
/// fewer than 3 views; without accept_weak, too few views, too little tilt or an uncertain focal
/// length (the message states its standard deviation, which follows from the corners' scatter); a
/// limit exceeded (for the reprojection error the message names the worst view); swapped images; a
/// rig that is not valid.
[[nodiscard]] Result<BoardCalibration> calibrate_boards(std::span<const BoardView> views,
                                                        const BoardPattern& pattern, int width,
                                                        int height, const BoardLimits& limits = {});

/// rms of y_left - y_right of the corners after rectification with `rig`, px.
[[nodiscard]] Result<double> row_error_px(std::span<const BoardView> views, const StereoRig& rig);

}  // namespace palpable
