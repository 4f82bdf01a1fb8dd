/// @file
/// A recording that plays at its own pace, as a camera would.
#pragma once

#include "palpable/live/sources/frame_source.h"
#include "palpable/live/sources/wall_clock.h"

#include <memory>

namespace palpable {

/// What a reader gets that comes when a later frame is due already.
enum class Late {
  kSkipped,  ///< the newest frame that is due: those before it are left out, the source is live
  kKept      ///< the next frame, at once: none is left out, and the reader sets the pace
};

/// Gives each frame when it is due, by its time since the first frame, or later.
///
/// @param clock  must outlive the source
[[nodiscard]] std::unique_ptr<FrameSource> paced(std::unique_ptr<FrameSource> source,
                                                 WallClock& clock = system_clock(),
                                                 Late late = Late::kSkipped);

}  // namespace palpable
