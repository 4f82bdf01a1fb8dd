/// @file
/// Reads calibration files of all kinds.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/frame.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

struct SourceCalibration {
  FrameFormat format;
  std::string file;  ///< that the numbers come from, for messages; of a data set also its name
  double frames_per_second = 30;
  bool rate_is_stated = false;
  std::optional<double> depth_unit;  ///< kColorDepth: m per step of a depth image, if in the file
  /// What was assumed because no file states it, one line each: a source reports them
  /// (take_notes()).
  std::vector<std::string> guesses = {};
  bool has_more_sizes = false;  ///< the file has numbers for pictures of other sizes, too
};

/// Which baselines are accepted.
enum class BaselineRule {
  kUsual,       ///< what_is_unlikely_about_baseline() refuses
  kAnyPossible  ///< 1 mm to 10 m, because the user said so (--baseline-ok)
};

/// Reads a file, or the only calibration in a folder, whose kind follows from its content
/// (calibration_kind.h):
///
///   SN*.conf        a ZED's factory numbers (factory_calibration.h)
///   OpenCV YAML     with K1: a rig of raw images; with fx: rows aligned (calibration_file.h)
///   of others       OpenCV's intrinsics.yml and extrinsics.yml, ROS's left.yaml and right.yaml,
///                   Kalibr's camchain, a RealSense's JSON and listing (foreign_calibration.h)
///   other text      colour + depth: `fx fy cx cy`, `... width height`, `... width height unit_m`,
///                   or the nine numbers fx 0 cx 0 fy cy 0 0 1; '#' begins a comment. A line
///                   `unit_m 0.0002` also states the step of the depth. If the colour camera has
///                   its own lens, one more line: `color fx fy cx cy`, followed by the 12 numbers
///                   of color_from_depth (row by row, m) if it has its own place
///
/// What is none of these is refused by the name of its program, or with what was looked for.
///
/// @param width, height  px, of one eye's image, to choose a size of a file that has several, and
///                       for files that state none; 0: unknown. The caller compares them with the
///                       calibration's. That of a file without a size is 0 x 0 if they are 0.
/// @param kind  what is wanted of a file that holds both, or one camera of a rig; nothing: stereo
/// A problem, one line that names the file, when it cannot be used. What the image's size decides
/// is judged only if the file has it; problem_with() judges the rest, and the baseline.
[[nodiscard]] Result<SourceCalibration> read_source_calibration(
    const std::filesystem::path& path, int width, int height,
    std::optional<FrameFormat::Kind> kind = std::nullopt);

/// The one judgement of every calibration that a source will use, once its size is known
/// (calibration_check.h). The message names the file.
/// @param if_meant  of an unlikely baseline: what to do if it is meant
[[nodiscard]] std::optional<Problem> problem_with(
    const SourceCalibration& calibration, BaselineRule rule,
    std::string_view if_meant = "--baseline-ok takes it as it is");

}  // namespace palpable
