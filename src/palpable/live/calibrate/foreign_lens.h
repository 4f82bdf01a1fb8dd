/// @file
/// Lenses and poses as other programs' calibration files state them. A problem is one line without
/// the file's name.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/camera.h"
#include "palpable/live/calibrate/keyed_text.h"

#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// The lens of a model with these coefficients. Models are known by the names that ROS, Kalibr,
/// RealSense and EuRoC give them; without a name the coefficients are OpenCV's. Only k1 k2 p1 p2 k3
/// are kept: a rational or thin-prism lens is one of these if its further numbers are 0.
/// @param coefficients  none, 4, 5, 8, 12 or 14
[[nodiscard]] Result<DistortedCamera> lens_of_model(const PinholeCamera& pinhole,
                                                    const std::vector<double>& coefficients,
                                                    std::string_view model);

/// Reads fx, fy, cx and cy (px) from a camera matrix. A problem when its rows are not fx 0 cx,
/// 0 fy cy, 0 0 1.
/// @param rows  the 9 numbers of the matrix, row by row
/// @param name  of the matrix, for the problem
[[nodiscard]] Result<PinholeCamera> camera_of_matrix(const std::vector<double>& rows,
                                                     std::string_view name, int width, int height);

/// The camera with this size of its picture, px. A problem when these are not whole numbers of
/// pixels.
[[nodiscard]] Result<PinholeCamera> with_size(PinholeCamera camera, double width, double height);

/// A pose of 12 or 16 numbers in row order, in m; the last row of 16 is 0 0 0 1.
[[nodiscard]] Result<Rigid3> pose_of_rows(const std::vector<double>& rows, std::string_view name);

/// The rotation nearest to a matrix that a file states with few digits. A matrix that is no
/// rotation is returned unchanged, and calibration_check.h refuses it.
[[nodiscard]] Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& R);

/// How far the lens moves the corners of the picture, px.
[[nodiscard]] double largest_distortion_px(const DistortedCamera& lens);

}  // namespace palpable
