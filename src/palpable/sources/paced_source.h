/// @file
/// A recording that plays at its own pace, as a camera would.
#pragma once

#include "palpable/sources/frame_source.h"
#include "palpable/sources/wall_clock.h"

#include <memory>

namespace palpable {

/// Gives each frame when it is due, by its time since the first frame. A reader that is late gets
/// the newest frame that is due; the frames before it are left out.
///
/// @param clock  must outlive the source
[[nodiscard]] std::unique_ptr<FrameSource> paced(std::unique_ptr<FrameSource> source,
                                                 WallClock& clock = system_clock());

}  // namespace palpable
