/// @file
/// The surface of a room from a whole recording (paper Sec. 3.3), loops closed. Where the camera
/// has been is known best at the end: what was fused along the way lies where the camera was not.
/// So a recording in which a loop was closed is played once more along the way as corrected.
/// Offline: it throws, and waits for its source.
#pragma once

#include "palpable/slam/slam.h"
#include "palpable/sources/frame_source.h"
#include "palpable/sources/source_guard.h"

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace palpable {

struct RoomScanSettings {
  SlamSettings slam{};   ///< `track` is set by whether there is a `pose_at`
  std::string name{};    ///< of the source, for messages
  int most_frames = -1;  ///< -1: up to the source's end
  /// Where the camera was at a time of the source, s (world_from_camera); nothing where nobody
  /// knows. Empty: it is followed.
  std::function<std::optional<Rigid3>(double time)> pose_at{};
};

/// How far a scan has come.
struct RoomScanStep {
  int read = 0;                      ///< frames of this pass
  int total = -1;                    ///< that there will be; -1: nobody knows
  bool again = false;                ///< it is the second pass
  int blocks = 0;                    ///< of the map
  std::vector<std::string> reports;  ///< of the source since the step before, a line each
};

struct RoomScan {
  std::unique_ptr<Slam> slam;  ///< of the last pass: its map holds the room
  PinholeCamera camera;
  std::vector<TrackedPose> frames;      ///< of the last pass
  std::vector<KeyframePose> keyframes;  ///< as adjusted last; none for poses that are given
  int loops = 0;                        ///< closed
  bool again = false;                   ///< there was a second pass
  SourceTroubles troubles;              ///< of the last pass
  std::string last_trouble;
};

/// Opens the source, from its beginning.
using OpenSource = std::function<std::unique_ptr<FrameSource>()>;

/// Plays a source, and a recording once more when a loop was closed. Without a single readable
/// frame the result has none.
/// @param go_on  called after each attempt to read a frame; false ends the first pass. The second
///               one has as many frames as the first and does not end before.
/// @throws Error for a format without depth and for images that do not fit their calibration, and
///         what `open` throws
[[nodiscard]] RoomScan scan_room(const OpenSource& open, const RoomScanSettings& settings,
                                 const std::function<bool(const RoomScanStep&)>& go_on);

/// Where each frame was seen from (world_from_camera) as its keyframe stands in the end; nothing
/// where it was not known or the keyframe was forgotten.
[[nodiscard]] std::vector<std::optional<Rigid3>> corrected_way(
    std::span<const TrackedPose> frames, std::span<const KeyframePose> keyframes);

}  // namespace palpable
