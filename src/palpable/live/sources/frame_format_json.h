/// @file
/// What all frames of a source have in common, as JSON: the calibration that a recording carries.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "palpable/common/geometry/frame.h"

namespace palpable {

/// A transform as 16 numbers, row by row; they come back to the bit.
[[nodiscard]] Json json_of(const Rigid3& transform);
/// @throws Error when it is no list of 16 numbers
[[nodiscard]] Rigid3 rigid_of(const Json& rows);

[[nodiscard]] Json json_of(const FrameFormat& format);
/// The same numbers to the bit. A problem, without a file's name, when they make no camera.
[[nodiscard]] Result<FrameFormat> frame_format_of(const Json& json);

}  // namespace palpable
