/// @file
/// A source's frame format as JSON: the calibration that is stored in a recording.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "palpable/common/geometry/frame.h"

namespace palpable {

/// A transform as 16 numbers in row order; reading them returns the identical bits.
[[nodiscard]] Json json_of(const Rigid3& transform);
/// @throws Error when it is not a list of 16 numbers
[[nodiscard]] Rigid3 rigid_of(const Json& rows);

[[nodiscard]] Json json_of(const FrameFormat& format);
/// Returns the identical numbers. A problem, without a file's name, when they are
/// not a valid camera.
[[nodiscard]] Result<FrameFormat> frame_format_of(const Json& json);

}  // namespace palpable
