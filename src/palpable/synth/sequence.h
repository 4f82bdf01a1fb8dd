/// @file
/// The sequences of the synthetic desk: what camera, rig, hands and things do over time, planned
/// before anything is drawn. docs/benchmark.md says what each promises.
///
/// A plan is a pure function of name, body, length and seed. Desk frame: desk_body.h. Camera: the
/// rectified left one. Moments are frame numbers (30 a second) and need not be whole, so that an
/// exposure can be opened in between.
#pragma once

#include "palpable/synth/desk_body.h"
#include "palpable/synth/desk_scene.h"
#include "palpable/synth/hand.h"
#include "palpable/synth/rig.h"

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

inline constexpr double kFramesPerSecond = 30.0;
/// The first frames of each sequence hold no hand.
inline constexpr int kFramesWithoutHand = 60;

/// A span of frames, both ends in it.
struct FrameSpan {
  int first = 0;
  int last = 0;
};

/// All that moves, at one moment, in the desk frame.
struct Movers {
  /// What touches, as capsules; empty while nothing is there. A cup is many: its wall.
  std::vector<HandCapsule> capsules;
  /// The middle of the cup's bottom, if there is one; its handle along X, its axis along Z.
  std::optional<Rigid3> desk_from_cup;
};

/// What the rig does in one frame.
struct RigState {
  double row_offset_px = 0;  ///< the right image lies so many rows lower than calibrated
  bool row_step = false;     ///< it jumped since the frame before
  double light = 1;          ///< of both eyes, linear: exposure and lamp together
  double exposure = 0;       ///< s that the shutter is open; 0: nothing is smeared
  double readout = 0;        ///< s from the first row to the last; 0: all at once
};

/// What a hand or a thing does to the body, as planned. The truth of contact is measured.
struct PlannedTouch {
  std::string what;             ///< "finger", "pencil", "cup", "palm", "slide"
  int site = -1;                ///< the nearest to the target
  bool between = false;         ///< aimed between two sites
  double depth = 0;             ///< m moved on from the first touch of the undeformed body
  FrameSpan frames;             ///< no touch before or after
  double seconds_to_depth = 0;  ///< from the start of the straight approach to the full depth
  double view_angle = 0;        ///< rad between the touching surface's normal and the ray
  Eigen::Vector3d first_touch = Eigen::Vector3d::Zero();  ///< middle of the tip then, desk frame
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();    ///< desk frame, unit
};

/// Frames in which something is so, e.g. "hand_in_front".
struct NamedSpan {
  std::string name;
  FrameSpan frames;
};

/// A plan.
struct Sequence {
  std::string name;
  std::uint64_t seed = 0;
  int frames = 0;
  DeskLook look;
  SensorFaults faults;
  Rigid3 desk_from_body = Rigid3::Identity();
  std::function<Rigid3(double)> camera_from_desk;
  std::function<Movers(double)> movers;
  std::function<RigState(int)> rig;
  std::vector<PlannedTouch> touches;
  std::vector<NamedSpan> spans;

  /// In the first camera.
  [[nodiscard]] Rigid3 camera_from_body() const { return camera_from_desk(0.0) * desk_from_body; }
};

/// What there is to choose from.
struct SequenceKind {
  std::string_view name;
  int frames;  ///< unless told otherwise
  std::string_view what;
};
[[nodiscard]] std::span<const SequenceKind> sequence_kinds();

/// @param name    one of sequence_kinds()
/// @param frames  >= 1; a sequence is cut or goes on in its manner, its speeds stay
/// @throws Error when the body cannot be touched as the sequence promises
[[nodiscard]] Sequence plan_sequence(std::string_view name, const DeskBody& body, int frames,
                                     std::uint64_t seed);

/// World is the first frame's camera.
[[nodiscard]] Rigid3 world_from_camera(const Sequence& sequence, double frame);

}  // namespace palpable
