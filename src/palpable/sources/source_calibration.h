/// @file
/// One reader for every file that says what a source's pixels mean.
#pragma once

#include "palpable/base/error.h"
#include "palpable/geometry/frame.h"

#include <filesystem>
#include <optional>

namespace palpable {

struct SourceCalibration {
  FrameFormat format;
  double frames_per_second = 30;
  std::optional<double> depth_unit;  ///< kColorDepth: m per step of a depth image, if it is said
};

/// Reads, by what the file holds,
///
///   SN*.conf        a ZED's factory numbers (factory_calibration.h)
///   OpenCV YAML     with K1: a rig of raw images; with fx: rows aligned (calibration_file.h)
///   other text      colour + depth: `fx fy cx cy`, `... width height`, `... width height unit_m`,
///                   or the nine numbers fx 0 cx 0 fy cy 0 0 1; '#' begins a comment. Where the
///                   colour is another view, a line more: `color fx fy cx cy`, and where it stands
///                   elsewhere the 12 numbers of color_from_depth (row by row, m) behind that
///
/// @param width, height  of one eye's image in px, to choose a section of a .conf; 0: not known.
///                       Whether they fit the calibration is for the caller to compare.
/// A problem, one line that names the file, when it cannot be used.
[[nodiscard]] Result<SourceCalibration> read_source_calibration(const std::filesystem::path& path,
                                                                int width, int height);

}  // namespace palpable
