/// @file
/// Calibrations that are two files, and calibrations in a folder.
#pragma once

#include "palpable/common/geometry/frame.h"
#include "palpable/live/sources/calibration_kind.h"

#include <optional>

namespace palpable {

/// The two files of a calibration: lenses and pose of OpenCV's, or left and right eye of ROS's.
struct CalibrationPair {
  CalibrationText first;
  CalibrationText second;
};

/// Finds the other half beside a file (is_half()): that of the same name with right for left,
/// extrinsics for intrinsics and so on, else the only one of its kind in the folder. The problem
/// names the file and says what the other one should be called.
[[nodiscard]] Result<CalibrationPair> pair_of(const CalibrationText& half);

/// The only calibration in a folder: a file, or one of a pair. Named as intrinsics.txt are files of
/// numbers only. The problem names the folder: it has none, or several.
/// @param kind  what is wanted: files that cannot be it are passed over, and of ROS's each is a
/// depth
///              camera's alone; nothing: any
[[nodiscard]] Result<CalibrationText> calibration_in(const std::filesystem::path& folder,
                                                     std::optional<FrameFormat::Kind> kind);

}  // namespace palpable
