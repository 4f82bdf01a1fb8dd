/// @file
/// Calibrations of other programs, as a source uses them.
#pragma once

#include "palpable/live/calibrate/calibration_file.h"
#include "palpable/live/sources/calibration_kind.h"
#include "palpable/live/sources/source_calibration.h"

#include <optional>
#include <string>

namespace palpable {

/// Reads a file of one of the kinds from kOpencvRig on, with its other half where it is one of two
/// files (calibration_partner.h). The parameters are those of read_source_calibration().
[[nodiscard]] Result<SourceCalibration> read_foreign_calibration(
    const CalibrationText& file, int width, int height, std::optional<FrameFormat::Kind> kind);

/// A rig as a source's calibration. A problem if it cannot be rectified; a rig without a size is
/// not judged.
/// @param file  the name of the file or the files, for messages
[[nodiscard]] Result<SourceCalibration> from_rig(const StereoCalibration& stereo,
                                                 const std::string& file);
[[nodiscard]] SourceCalibration from_rectified(const RectifiedCalibration& rectified,
                                               const std::string& file);

}  // namespace palpable
