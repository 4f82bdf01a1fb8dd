/// @file
/// Plays a recording at its own pace, as a camera would.
#pragma once

#include "palpable/live/sources/frame_source.h"
#include "palpable/live/sources/wall_clock.h"

#include <memory>

namespace palpable {

/// What a late reader receives, i.e. one that comes when a later frame is already due.
enum class Late {
  kSkipped,  ///< the newest frame that is due; earlier ones are skipped, the source is live
  kKept      ///< the next frame at once; none is skipped, and the reader sets the pace
};

/// Returns each frame when it is due according to its time since the first frame, or later.
///
/// @param clock  must outlive the source
[[nodiscard]] std::unique_ptr<FrameSource> paced(std::unique_ptr<FrameSource> source,
                                                 WallClock& clock = system_clock(),
                                                 Late late = Late::kSkipped);

}  // namespace palpable
