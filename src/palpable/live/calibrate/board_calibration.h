/// @file
/// A rig's calibration from pictures of a chessboard (paper Sec. 3.3: intrinsics, distortion and
/// the pose between the eyes are known beforehand), and where a chessboard stands.
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

/// Counted in inner corners, where four squares meet: an ordinary chessboard has 7 x 7.
struct BoardPattern {
  int columns = 9;
  int rows = 6;
  double square = 0.025;  ///< m, side of a square; the calibration's lengths are in proportion
};

/// The board as both eyes saw it at one moment; corner (row, column) is at row * columns + column,
/// px of the raw images.
struct BoardView {
  int number = 0;  ///< of the frame
  std::vector<Eigen::Vector2d> left;
  std::vector<Eigen::Vector2d> right;
};

/// The corners, to a few hundredths of a pixel in a sharp picture; nothing unless both eyes see the
/// whole board. Costs a tenth of a second and more.
[[nodiscard]] std::optional<BoardView> find_board(const ColorImage& left, const ColorImage& right,
                                                  const BoardPattern& pattern);

/// camera_from_board of the board that one picture shows: the origin in the middle of its corners,
/// Z out of the board towards the camera, X along the side that runs most to the right in the
/// picture. So the pose does not depend on which corner was found first. The reprojection error of
/// all corners is least (Collins and Bartoli 2014, IPPE, then cv::solvePnPRefineLM).
///
/// @param camera  of the picture, which has no distortion
/// @return nothing when the whole board is not seen
[[nodiscard]] std::optional<Rigid3> find_board_pose(const ColorImage& image,
                                                    const PinholeCamera& camera,
                                                    const BoardPattern& pattern);

/// Mean distance between the corners of two views in px, over both eyes: a second view that hardly
/// differs from the first adds nothing to a calibration.
[[nodiscard]] double difference_px(const BoardView& a, const BoardView& b);

/// Limits beyond which a calibration is refused.
struct BoardLimits {
  /// Take what too few or too little tilted boards, or a focal length that is not known well, give,
  /// with BoardCalibration::weakness. The other limits stay.
  bool accept_weak = false;
  int fewest_views = 6;
  /// rad between the most different two boards. Boards that are all parallel to the image leave
  /// focal length and distance undecided.
  double least_tilt = 0.26;
  double largest_reprojection_px = 1.0;  ///< rms
  /// rms. Stereo matching searches along one row: beyond half a pixel its matches get worse.
  double largest_row_error_px = 0.5;
  double largest_focal_sigma = 0.01;  ///< of the focal length
};

struct BoardCalibration {
  StereoCalibration calibration;
  double reprojection_px = 0;            ///< rms over all corners of both eyes
  std::vector<double> reprojections_px;  ///< the same view by view
  double row_error_px = 0;  ///< rms of y_left - y_right of the corners after rectification
  double focal_sigma = 0;   ///< standard deviation of the left fx, as a share of it
  /// Why it would have been refused without accept_weak, and how well the focal length is known
  /// then; empty where all is well.
  std::string weakness;
  double tilt = 0;     ///< rad between the most different two boards
  double covered = 0;  ///< share of the left image inside the hull of all corners
};

/// Each eye by Zhang's method (cv::calibrateCamera with k1 k2 p1 p2), then both and the pose
/// between them together (cv::stereoCalibrate).
///
/// A problem, without a file's name, when there is no calibration or it cannot be trusted: fewer
/// than 3 views, or without accept_weak too few, too little tilt or a focal length that is not
/// known well (it is said how well, which is what follows from the corners' scatter), a limit
/// exceeded (the worst view is named), eyes swapped, a rig that is not sound.
[[nodiscard]] Result<BoardCalibration> calibrate_boards(std::span<const BoardView> views,
                                                        const BoardPattern& pattern, int width,
                                                        int height, const BoardLimits& limits = {});

/// rms of y_left - y_right of the corners in px once `rig` has rectified them.
[[nodiscard]] Result<double> row_error_px(std::span<const BoardView> views, const StereoRig& rig);

}  // namespace palpable
