/// @file
/// The surface of a room from a whole recording (paper Sec. 3.3), with loops closed. Only at the
/// end of a recording it is known best where the camera was; what was fused before a loop was
/// closed lies in wrong places. So a recording in which a loop was closed is played a second time,
/// along the corrected path. Offline: it throws, and waits for its source.
#pragma once

#include "palpable/live/depth/depth_settings.h"
#include "palpable/live/slam/slam.h"
#include "palpable/live/sources/frame_source.h"
#include "palpable/live/sources/source_guard.h"

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace palpable {

struct RoomScanSettings {
  DepthSettings depth{};  ///< how its frames are measured
  SlamSettings slam{};    ///< its `track` is not read: the camera is tracked without a `pose_at`
  std::string name{};     ///< of the source, for messages
  int most_frames = -1;   ///< -1: up to the source's end
  /// world_from_camera at a time of the source, s; nothing where it is not known. Empty: the camera
  /// is tracked.
  std::function<std::optional<Rigid3>(double time)> pose_at{};
};

/// How far a scan has come.
struct RoomScanStep {
  int read = 0;                      ///< frames of this pass so far
  int total = -1;                    ///< frames of the whole pass; -1: not known
  bool again = false;                ///< this is the second pass
  int blocks = 0;                    ///< of the map
  std::vector<std::string> reports;  ///< what went wrong with the source since the last step, a
                                     ///< line each
};

struct RoomScan {
  std::unique_ptr<Slam> slam;           ///< of the last pass: its map holds the room
  PinholeCamera camera;                 ///< of the frames
  std::vector<TrackedPose> frames;      ///< of the last pass
  std::vector<KeyframePose> keyframes;  ///< as adjusted last; none where poses were given
  int loops = 0;                        ///< that were closed
  int new_worlds = 0;                   ///< that began after the camera was lost
  bool again = false;                   ///< there was a second pass
  SourceTroubles troubles;              ///< of the last pass
  std::string last_trouble;             ///< its message; empty: there was none
};

/// Opens the source at its beginning.
using OpenSource = std::function<std::unique_ptr<FrameSource>()>;

/// Plays a source, and plays it again if it is a recording and a loop was closed. If no frame can
/// be read the result has no frames.
/// @param go_on  is called after each attempt to read a frame; if it returns false the first pass
///               ends. The second pass always has as many frames as the first.
/// @throws Error for a format without depth and for images that do not fit their calibration, and
///         what `open` throws
[[nodiscard]] RoomScan scan_room(const OpenSource& open, const RoomScanSettings& settings,
                                 const std::function<bool(const RoomScanStep&)>& go_on);

/// What was seen, as a surface: what several frames agree on (SurfaceMap::mesh), or all of it where
/// three frames or fewer were used, one pair of pictures for instance.
[[nodiscard]] ColoredSurface surface_of(const RoomScan& scan);

/// Lines for people: frames, what could not be read, loops.
[[nodiscard]] std::string text_of(const RoomScan& scan);

/// world_from_camera of each frame, as it follows from the final pose of its keyframe; nothing
/// where the frame had no pose or its keyframe was forgotten.
[[nodiscard]] std::vector<std::optional<Rigid3>> corrected_path(
    std::span<const TrackedPose> frames, std::span<const KeyframePose> keyframes);

}  // namespace palpable
