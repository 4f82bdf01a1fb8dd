/// @file
/// How long one step of a depth image's numbers is. Files and devices seldom say; a wrong unit
/// makes the scene too large or too small without any other sign.
#pragma once

#include "palpable/common/geometry/frame.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// The allowed lengths of one step, m. Outside of them the number is no length in metres: 5000 is
/// TUM's number of steps in a metre, and 2e-7 m would end the range of 16 bits at 13 mm.
inline constexpr double kLeastDepthUnit = 1e-6;
inline constexpr double kLargestDepthUnit = 1;
/// m, of most files and sensors; taken where nothing states a unit.
inline constexpr double kUsualDepthUnit = 1e-3;

/// Why `metres` is not the length of a step, and what would be; empty if it is within the bounds.
[[nodiscard]] std::string what_is_wrong_with_depth_unit(double metres);

/// "0.2 mm": the length of a step, for messages.
[[nodiscard]] std::string depth_unit_text(double metres);

/// The unit of a video device whose pictures are Z16, m, by the maker's name for it; empty if the
/// name is not known, or is one of several devices with different units.
[[nodiscard]] std::optional<double> known_depth_unit(std::string_view device);

/// What may state the unit of a source, m. The first that is given counts, in this order.
struct DepthUnitStatements {
  std::optional<double> asked;        ///< by the user (--depth-unit)
  std::optional<double> calibration;  ///< by intrinsics.txt
  std::optional<double> known;        ///< by the layout of the folder, or by known_depth_unit()
  std::string known_of = {};          ///< what `known` is known of, for messages
};

/// Sets depth_unit and depth_unit_assumed of a colour + depth format.
/// @param source  name of the depth images or the device, for messages
/// @return what the user should know: empty if the user or a file stated the unit, else one line
[[nodiscard]] std::vector<std::string> decide_depth_unit(const DepthUnitStatements& stated,
                                                         const std::string& source,
                                                         FrameFormat& format);

}  // namespace palpable
