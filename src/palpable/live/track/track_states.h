/// @file
/// Is the camera's pose known, and by what? The states of the tracker and what leads from one to
/// the next. The tracker (tracker.h) finds out what a frame shows; next_state() decides.
///
/// Before the first keyframe there is no world in which anything could have a place:
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
/// kFixed also stays on kPatchesAtRest, kPoseAtRest and kHidden, kTracking on kPoseFound, kLost on
/// kNoPose and kUnreadable.
#pragma once

namespace palpable {

enum class TrackState {
  kStarting,  ///< there is no keyframe yet; the camera stands where it began, as far as can be seen
  kFixed,     ///< the camera stands still; the pose is that of the moment when it came to rest
  kTracking,  ///< the camera moves and its pose is known
  kLost       ///< the pose is not known; the tracker repeats the last one that was
};

/// What one frame shows, the strongest statement that can be made of it.
enum class FrameEvidence {
  kUnreadable,  ///< no images, or images of another size than the camera's

  // Without a keyframe:
  kStartView,      ///< the first view that showed something is seen again
  kOtherView,      ///< something else is seen, or nothing that could be compared
  kFirstKeyframe,  ///< enough landmarks: the frame became the first keyframe

  // With a keyframe:
  kPatchesAtRest,  ///< the patches of the resting view are where they were; nothing else was done
  kPoseAtRest,     ///< a pose was found, and it differs from the resting one by noise only
  kPoseFound,      ///< a pose was found
  kCameToRest,     ///< a pose was found, and the picture has not moved for 0.7 s
  kHidden,         ///< no pose, but for less than a second too little has been seen to compare with
                   ///< the resting view: a hand before the lens, a light that is switched off
  kNoPose          ///< no pose was found
};

/// The state after a frame. Defined for all pairs; evidence that belongs to a standing camera
/// (kPoseAtRest, kHidden) says of any other what it says without the rest: a pose was found, or
/// none was.
[[nodiscard]] TrackState next_state(TrackState before, FrameEvidence evidence);

}  // namespace palpable
