/// @file
/// A sequence of the synthetic desk: where camera, hands and things are at every moment, what the
/// rig does in every frame, and which touches are planned. Nothing here is drawn: the film module
/// turns a sequence into images; plan_sequence.h makes one.
///
/// Desk frame: desk_body.h. Camera: the rectified left one. A moment is a frame number (30 frames a
/// second) and need not be whole: an exposure begins and ends between frames.
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
/// The first frames of each sequence hold no hand.
inline constexpr int kFramesWithoutHand = 60;

/// A span of frames that includes both ends.
struct FrameSpan {
  int first = 0;
  int last = 0;
};

/// Everything that moves, except the camera, at one moment; desk frame.
struct Movers {
  /// The surfaces that can touch. Empty while neither hand nor thing is there. The wall of a cup is
  /// a ring of capsules (things.h).
  std::vector<HandCapsule> capsules;
  /// Where the cup is, if there is one; things.h has its frame.
  std::optional<Rigid3> desk_from_cup;
};

/// What the rig does in one frame.
struct RigState {
  double row_offset_px = 0;  ///< how far the right image lies below where the calibration says
  bool row_step = false;     ///< row_offset_px jumped since the frame before
  double light = 1;     ///< linear factor on the light of both eyes: exposure and lamp together
  double exposure = 0;  ///< s for which the shutter is open; 0: nothing is smeared
  double readout = 0;   ///< s from reading the first row to reading the last; 0: all at once
};

/// What a hand or a thing does to the body, as planned. What truly happens in a frame is measured:
/// contact_truth.h.
struct PlannedTouch {
  std::string what;             ///< "finger", "pencil", "cup", "palm", "slide"
  int site = -1;                ///< the site nearest to the target
  bool between = false;         ///< aimed between two sites
  double depth = 0;             ///< m moved on after first touching the undeformed body
  FrameSpan frames;             ///< outside of them the hand does not touch
  double seconds_to_depth = 0;  ///< from the start of the straight approach to the full depth
  double view_angle = 0;        ///< rad between the touching surface's normal and the ray
  /// Middle of the touching tip's sphere at the first touch; desk frame.
  Eigen::Vector3d first_touch = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< of the press; desk frame, unit
};

/// Frames with a name, e.g. "hand_in_front".
struct NamedSpan {
  std::string name;
  FrameSpan frames;
};

/// All functions are pure: the same moment gives the same answer.
struct Sequence {
  std::string name;
  std::uint64_t seed = 0;
  int frames = 0;
  DeskLook look;
  SensorFaults faults;
  Rigid3 desk_from_body = Rigid3::Identity();
  std::function<Rigid3(double)> camera_from_desk;  ///< at a moment
  std::function<Movers(double)> movers;            ///< at a moment
  std::function<RigState(int)> rig;                ///< in a frame
  std::vector<PlannedTouch> touches;
  std::vector<NamedSpan> spans;

  /// Where the body stands in the first frame's camera.
  [[nodiscard]] Rigid3 camera_from_body() const { return camera_from_desk(0.0) * desk_from_body; }
};

/// The world frame is the first frame's camera.
[[nodiscard]] inline Rigid3 world_from_camera(const Sequence& sequence, double frame) {
  return sequence.camera_from_desk(0.0) * sequence.camera_from_desk(frame).inverse();
}

}  // namespace palpable
