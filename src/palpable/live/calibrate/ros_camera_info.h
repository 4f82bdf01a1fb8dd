/// @file
/// ROS's camera_info: a file for each eye, as camera_calibration writes them (left.yaml and
/// right.yaml) or as a message is printed (width, height, K, D, R, P; in ROS 2 in small letters).
///
/// R turns the eye's frame to the rectified one. P is the rectified camera, in which
///
///     P[3] = -fx baseline      of the right eye, 0 of the left one
///
/// in the unit of the board's squares, which ROS wants in metres.
#pragma once

#include "palpable/live/calibrate/foreign_lens.h"

namespace palpable {

struct RosCamera {
  DistortedCamera lens;
  Eigen::Matrix3d rectified_from_camera = Eigen::Matrix3d::Identity();
  /// Row by row; 0 if the file has none.
  Eigen::Matrix<double, 3, 4> projection = Eigen::Matrix<double, 3, 4>::Zero();
};

[[nodiscard]] bool is_ros_camera(const KeyedText& text);

[[nodiscard]] Result<RosCamera> read_ros_camera(const KeyedText& text);

/// The pose between the eyes follows from R and P of both. Problems: no P, no baseline in them.
[[nodiscard]] Result<StereoRig> rig_of_ros(const RosCamera& left, const RosCamera& right);

/// The pair of pictures that are rectified already: of both eyes the distortion is 0, R is I and
/// the camera_matrix is that of P. Nothing for others.
[[nodiscard]] std::optional<RectifiedStereo> rectified_of_ros(const RosCamera& left,
                                                              const RosCamera& right);

/// The text of left.yaml or right.yaml. @param name  the camera_name
[[nodiscard]] std::string ros_camera_text(const RosCamera& camera, std::string_view name);

}  // namespace palpable
