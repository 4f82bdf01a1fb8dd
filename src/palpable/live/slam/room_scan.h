/// @file
/// The surface of a room from a whole recording (paper Sec. 3.3), with loops closed. The camera's
/// path is known best at the end of a recording; surfaces that were fused before a loop was closed
/// are misplaced by the drift. So a recording in which a loop was closed is played a second time,
/// along the corrected path. Offline code: it throws, and waits for its source.
#pragma once

#include "palpable/live/depth/depth_settings.h"
#include "palpable/live/depth/depth_survey.h"
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
  DepthSettings depth{};  ///< for the depth of its frames
  SlamSettings slam{};    ///< `track` is ignored: the camera is tracked if `pose_at` is empty
  std::string name{};     ///< of the source, for messages
  int most_frames = -1;   ///< largest number of frames; -1: up to the source's end
  /// Returns world_from_camera at a time of the source, s, or nothing if it is not known. Empty:
  /// the camera is tracked.
  std::function<std::optional<Rigid3>(double time)> pose_at{};
};

/// Sets the range of the surface and the accuracy that its depths must have, and that of the depth
/// camera, which is not smaller than usual. @param farthest  m, > 0
void set_farthest(double farthest, RoomScanSettings& settings);

/// The progress of a scan.
struct RoomScanStep {
  int read = 0;                      ///< frames of this pass so far
  int total = -1;                    ///< frames of the whole pass; -1: not known
  bool again = false;                ///< this is the second pass
  int blocks = 0;                    ///< of the map
  std::vector<std::string> reports;  ///< troubles of the source since the last step, a line each
};

struct RoomScan {
  std::unique_ptr<Slam> slam;           ///< of the last pass: its map contains the room
  PinholeCamera camera;                 ///< of the frames
  std::vector<TrackedPose> frames;      ///< of the last pass
  std::vector<KeyframePose> keyframes;  ///< final poses; empty if poses were given
  int loops = 0;                        ///< number of loops closed
  int new_worlds = 0;                   ///< number of worlds begun after the camera was lost
  bool again = false;                   ///< there was a second pass
  SourceTroubles troubles;              ///< of the last pass
  std::string last_trouble;             ///< message of the last trouble; empty: there was none
  DepthFigures depth;                   ///< of the first pass
};

/// Opens the source at its beginning.
using OpenSource = std::function<std::unique_ptr<FrameSource>()>;

/// Plays a source, and plays it again if it is a recording and a loop was closed. If no frame can
/// be read the result has no frames.
/// @param go_on  is called after each attempt to read a frame; if it returns false the first pass
///               ends. The second pass always processes as many frames as the first.
/// @throws Error for a format without depth and for images that do not fit their calibration, and
///         what `open` throws
[[nodiscard]] RoomScan scan_room(const OpenSource& open, const RoomScanSettings& settings,
                                 const std::function<bool(const RoomScanStep&)>& go_on);

/// The surface of the scene: the part on which several frames agree (SurfaceMap::mesh), or all of
/// it if at most three frames were fused, for instance from a single pair of pictures.
[[nodiscard]] ColoredSurface surface_of(const RoomScan& scan);

/// A summary for the user, in lines: numbers of frames, unreadable frames, loops.
[[nodiscard]] std::string text_of(const RoomScan& scan);

/// world_from_camera of each frame, computed with the final pose of its keyframe; nothing if the
/// frame had no pose or its keyframe was removed.
[[nodiscard]] std::vector<std::optional<Rigid3>> corrected_path(
    std::span<const TrackedPose> frames, std::span<const KeyframePose> keyframes);

}  // namespace palpable
