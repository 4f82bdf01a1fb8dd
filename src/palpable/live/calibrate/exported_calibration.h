/// @file
/// A rig's calibration as other programs read it.
#pragma once

#include "palpable/common/geometry/camera.h"

#include <array>
#include <filesystem>

namespace palpable {

/// The files that export_calibration() writes: intrinsics.yml (M1 D1 M2 D2) and extrinsics.yml (R T
/// R1 R2 P1 P2 Q) as OpenCV's sample stereo_match reads them, left.yaml and right.yaml as ROS does
/// (camera_info). Lengths in m, all digits.
inline constexpr std::array<const char*, 4> kExportedFiles{"intrinsics.yml", "extrinsics.yml",
                                                           "left.yaml", "right.yaml"};

/// Writes them into a folder, which is made if it is not there; the one above it must be.
/// @pre  the rig can be rectified
/// @throws Error if a file cannot be written
void export_calibration(const std::filesystem::path& folder, const StereoRig& rig);

}  // namespace palpable
