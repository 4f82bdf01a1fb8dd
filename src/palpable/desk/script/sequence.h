/// @file
/// A sequence of the synthetic desk: the poses of camera, hands and things at every time, the state
/// of the rig in every frame, and the planned touches. plan_sequence.h makes sequences; the film
/// module renders them.
///
/// Desk frame: desk_body.h. Camera: the rectified left one. Times are in frames (30 per second) and
/// need not be whole, since an exposure begins and ends between frames.
#pragma once

#include "palpable/common/geometry/rigid.h"
#include "palpable/desk/script/desk_look.h"
#include "palpable/desk/script/hand.h"
#include "palpable/desk/script/rig.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

inline constexpr double kFramesPerSecond = 30.0;
/// Number of frames without a hand at the beginning of each sequence.
inline constexpr int kFramesWithoutHand = 60;

/// A span of frames that includes both ends.
struct FrameSpan {
  int first = 0;
  int last = 0;
};

/// Everything that moves, except the camera, at one time; desk frame.
struct Movers {
  /// The surfaces that can touch; empty while there is neither hand nor thing. The wall of a cup is
  /// a ring of capsules (things.h).
  std::vector<HandCapsule> capsules;
  /// The pose of the cup, if there is one; things.h defines its frame.
  std::optional<Rigid3> desk_from_cup;
};

/// The state of the rig in one frame.
struct RigState {
  double row_offset_px = 0;  ///< px, how much lower the right image lies than calibrated
  bool row_step = false;     ///< whether row_offset_px jumped since the previous frame
  double light = 1;          ///< linear factor of the light in both eyes, from exposure and lamp
  double exposure = 0;       ///< s, time that the shutter is open; 0: no motion blur
  double readout = 0;        ///< s, from reading the first row to the last; 0: global shutter
};

/// A planned touch of the body by a hand or thing. The true contact in a frame is computed from the
/// geometry (contact_truth.h).
struct PlannedTouch {
  std::string what;             ///< "finger", "thumb", "pencil", "cup", "palm" or "slide"
  int site = -1;                ///< the site nearest to the target
  bool between = false;         ///< whether the target lies between two sites
  double depth = 0;             ///< m, motion after the first touch of the undeformed body
  FrameSpan frames;             ///< outside of these the hand does not touch
  double seconds_to_depth = 0;  ///< from the start of the straight approach to the full depth
  double view_angle = 0;        ///< rad between the touching surface's normal and the ray
  /// Centre of the touching tip's sphere at the first touch; desk frame.
  Eigen::Vector3d first_touch = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< of the press; desk frame, unit
};

/// Frames with a name, e.g. "hand_in_front".
struct NamedSpan {
  std::string name;
  FrameSpan frames;
};

/// All functions are pure: equal times give equal results.
struct Sequence {
  std::string name;
  std::uint64_t seed = 0;
  int frames = 0;
  DeskLook look;
  SensorFaults faults;
  Rigid3 desk_from_body = Rigid3::Identity();
  std::function<Rigid3(double)> camera_from_desk;  ///< at a time
  std::function<Movers(double)> movers;            ///< at a time
  std::function<RigState(int)> rig;                ///< in a frame
  std::vector<PlannedTouch> touches;
  std::vector<NamedSpan> spans;

  /// The pose of the body in the camera frame of the first frame.
  [[nodiscard]] Rigid3 camera_from_body() const { return camera_from_desk(0.0) * desk_from_body; }
};

/// world_from_camera at a time; the world frame is the camera frame of the first frame.
[[nodiscard]] inline Rigid3 world_from_camera(const Sequence& sequence, double frame) {
  return sequence.camera_from_desk(0.0) * sequence.camera_from_desk(frame).inverse();
}

}  // namespace palpable
