/// @file
/// Camchains of Kalibr and OpenVINS: cam0, cam1 with camera_model, intrinsics (fu fv pu pv, px),
/// distortion_model, distortion_coeffs, resolution, and the pose T_cn_cnm1 (m), by which points of
/// cam0 become points of cam1: it is right_from_left. If it is missing it follows from both
/// cameras' T_cam_imu or T_imu_cam.
#pragma once

#include "palpable/live/calibrate/foreign_lens.h"

namespace palpable {

[[nodiscard]] bool is_camchain(const KeyedText& text);

/// cam0 and cam1 as left and right eye. Problems, without the file's name: one camera only, a model
/// that is not pinhole (omni, ds, eucm), a lens that is not radtan (equidistant, fov), no pose.
[[nodiscard]] Result<StereoRig> rig_of_camchain(const KeyedText& text);

/// cam0 alone.
[[nodiscard]] Result<DistortedCamera> camera_of_camchain(const KeyedText& text);

}  // namespace palpable
