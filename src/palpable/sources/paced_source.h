/// @file
/// A recording that plays at its own pace, as a camera would.
#pragma once

#include "palpable/sources/frame_source.h"
#include "palpable/sources/wall_clock.h"

#include <memory>

namespace palpable {

/// Gives each frame when its time has come, counted from the first; a reader that is late gets the
/// newest frame that is due, and those before it are passed over.
///
/// @param clock  must outlive the source
[[nodiscard]] std::unique_ptr<FrameSource> paced(std::unique_ptr<FrameSource> source,
                                                 WallClock& clock = system_clock());

}  // namespace palpable
