/// @file
/// Reads calibration files of all kinds.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/frame.h"

#include <filesystem>
#include <optional>

namespace palpable {

struct SourceCalibration {
  FrameFormat format;
  double frames_per_second = 30;
  std::optional<double> depth_unit;  ///< kColorDepth: m per step of a depth image, if in the file
};

/// Reads a file whose kind follows from its content:
///
///   SN*.conf        a ZED's factory numbers (factory_calibration.h)
///   OpenCV YAML     with K1: a rig of raw images; with fx: rows aligned (calibration_file.h)
///   other text      colour + depth: `fx fy cx cy`, `... width height`, `... width height unit_m`,
///                   or the nine numbers fx 0 cx 0 fy cy 0 0 1; '#' begins a comment. If the
///                   colour camera has its own lens, one more line: `color fx fy cx cy`, followed
///                   by the 12 numbers of color_from_depth (row by row, m) if it has its own place
///
/// @param width, height  px, of one eye's image, to choose a section of a .conf; 0: unknown. The
///                       caller compares them with the calibration's.
/// A problem, one line that names the file, when it cannot be used.
[[nodiscard]] Result<SourceCalibration> read_source_calibration(const std::filesystem::path& path,
                                                                int width, int height);

}  // namespace palpable
