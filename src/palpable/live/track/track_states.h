/// @file
/// The states of the tracker, which describe whether and how the camera's pose is known, and the
/// transitions between them. The tracker (tracker.h) determines the evidence of a frame;
/// next_state() determines the state that follows.
///
/// Before the first keyframe there is no world frame:
///
///     +-----------+   kOtherView, kUnreadable    +-----------+
///     | kStarting | ---------------------------> |   kLost   |
///     |           | <--------------------------- |           |
///     +-----------+           kStartView         +-----------+
///           |                                          |
///           | kFirstKeyframe                           | kFirstKeyframe
///           v                                          v
///        kFixed: the world begins              kFixed: a new world begins
///
/// Afterwards:
///
///                           kPoseFound
///     +-----------+ ---------------------------> +-----------+
///     |  kFixed   |                              | kTracking |
///     +-----------+ <--------------------------- +-----------+
///       |       ^           kCameToRest            |       ^
///       |       |                                  |       |
///       |       | kPatchesAtRest                   |       | kPoseFound
///       |       | kCameToRest                      |       |
///       v       |                                  v       |
///     +----------------------------------------------------------+
///     |                          kLost                           |
///     +----------------------------------------------------------+
///       down: kNoPose, kUnreadable
///
/// Some evidence does not change the state: kPatchesAtRest, kPoseAtRest and kHidden in kFixed,
/// kPoseFound in kTracking, kNoPose and kUnreadable in kLost.
#pragma once

namespace palpable {

enum class TrackState {
  kStarting,  ///< there is no keyframe yet; no motion since the start was detected
  kFixed,     ///< the camera stands still; the pose is that of the moment when it came to rest
  kTracking,  ///< the camera moves and its pose is known
  kLost       ///< the pose is not known; the tracker repeats the last known one
};

/// The evidence of one frame: the strongest statement that it supports.
enum class FrameEvidence {
  kUnreadable,  ///< no images, or images of another size than the camera's

  // Without a keyframe:
  kStartView,      ///< the view equals the first one that could be compared
  kOtherView,      ///< the view differs, or cannot be compared
  kFirstKeyframe,  ///< enough landmarks: the frame became the first keyframe

  // With a keyframe:
  kPatchesAtRest,  ///< the patches of the view at rest have not moved; nothing else was computed
  kPoseAtRest,     ///< a pose was found that differs from the pose at rest by noise only
  kPoseFound,      ///< a pose was found
  kCameToRest,     ///< a pose was found, and the picture has not moved for 0.7 s
  kHidden,         ///< no pose was found, but since less than a second too little is visible to
                   ///< compare with the view at rest: a hand before the lens, a light switched off
  kNoPose          ///< no pose was found
};

/// The state after a frame, defined for all pairs. Only in kFixed, where the camera rests and its
/// pose is kept, does it matter that the camera is still at rest or its view hidden: in other
/// states kPoseAtRest counts as kPoseFound, and kHidden as kNoPose.
[[nodiscard]] TrackState next_state(TrackState before, FrameEvidence evidence);

}  // namespace palpable
