/// @file
/// Judges the numbers of a calibration, whatever file or call they come from. Depth is right by as
/// much as the baseline is, and nothing in the pictures tells its unit.
///
/// Each function returns one line without a file's name, or an empty text if there is no fault.
#pragma once

#include "palpable/common/geometry/frame.h"

#include <string>
#include <string_view>

namespace palpable {

inline constexpr int kLargestImageSide = 16384;  ///< px; larger values are mistakes or attacks

/// Largest entry of |R^T R - I| of a rotation; files have few digits.
inline constexpr double kLargestRotationError = 1e-3;

/// Faults of a camera: sides that are not 1 to 16384 px, numbers that are not finite, a focal
/// length outside 0.04 to 600 times the longer side, a principal point outside the picture.
/// @param name  in the message: "the NAME image", "the NAME focal length"
[[nodiscard]] std::string what_is_wrong_with(const PinholeCamera& camera, std::string_view name);

/// Further faults of a rig: a distortion that no lens has, an R that is not a rotation
/// (kLargestRotationError, or det R < 0), a baseline that is not within 1 mm .. 10 m
/// (a file in millimetres is a common mistake), cameras that do not stand side by side, in the
/// wrong order, or whose axes differ by more than 40 degrees.
[[nodiscard]] std::string what_is_wrong_with(const StereoRig& rig);
/// The same for a pair whose rows are aligned already.
[[nodiscard]] std::string what_is_wrong_with(const RectifiedStereo& stereo);
/// Those of the format's kind; for colour + depth of both lenses, of the pose between them (a
/// rotation, 1 m at most) and of sizes that differ from the images'.
[[nodiscard]] std::string what_is_wrong_with(const FrameFormat& format);

/// What contradicts that two cameras are the eyes of one rectified pair: focal lengths that differ
/// by 1 % or rows that differ by 1 px; empty if nothing does. cx may differ.
[[nodiscard]] std::string what_contradicts(const PinholeCamera& left, const PinholeCamera& right);

/// "63.0 mm" or "0.537 m".
[[nodiscard]] std::string baseline_text(double baseline);

inline constexpr double kUsualShortestBaseline = 0.01;  ///< m
inline constexpr double kUsualLongestBaseline = 1.0;    ///< m, a car's rig has 0.54

/// What is unlikely about a baseline that is possible: outside the two bounds above its unit is
/// nearly always not the metre. Board calibrations give it in squares of the board unless the side
/// of a square was entered, rulers in centimetres. Names these units, not the remedy of a caller.
/// @param baseline  m, > 0
[[nodiscard]] std::string what_is_unlikely_about_baseline(double baseline);

}  // namespace palpable
