/// @file
/// The actions of one hand during a sequence: it enters, presses, returns to its rest position, and
/// so on. Each press is checked against the body's surface before it is added.
#pragma once

#include "palpable/desk/script/desk_body.h"
#include "palpable/desk/script/hand_path.h"
#include "palpable/desk/script/press_search.h"
#include "palpable/desk/script/press_style.h"
#include "palpable/desk/script/sequence.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace palpable {

/// The position of the tip when the knuckles of the passing (open) hand are at a given position; in
/// the same frame.
/// @param turn  desk from wrist
[[nodiscard]] Eigen::Vector3d tip_for_knuckles(const HandTool& tool,
                                               const Eigen::Vector3d& knuckles,
                                               const Eigen::Quaterniond& turn);

/// Rotations of a hand, desk from wrist: at rest beside the body, and before the camera.
[[nodiscard]] Eigen::Quaterniond resting_turn();
[[nodiscard]] Eigen::Quaterniond turn_before_camera();

/// What moves where one hand follows a path, from kFramesWithoutHand on.
[[nodiscard]] std::function<Movers(double)> hand_alone(HandPath path);

/// Builds the path of a hand and the list of its touches, action by action.
class HandScript {
 public:
  /// The hand enters from the right and rests beside the body. All arguments except the seed must
  /// outlive the script.
  /// @param surface  surface of the body that `search` uses, desk frame
  /// @param seed     seed of the hand's tremor
  HandScript(const PressSearch& search, const SurfacePoints& surface, const PressStyle& style,
             std::uint64_t seed);

  /// Durations of the parts of a press, frames: to the full depth, at full depth, back out.
  struct Pace {
    double in, hold, out;
  };

  /// Adds a press and the return to the rest position. Returns false and adds nothing when the hand
  /// would touch the desk, touch the body away from the target, or not touch it at all; why_not()
  /// then gives the reason.
  bool press(const PressPosture& posture, double depth, const Pace& pace);

  /// Like press(), but at the full depth the hand slides along the surface to another target. Also
  /// returns false when the surface in between has a fold that a finger cannot follow.
  bool slide(const PressPosture& from, const PressTarget& to, double depth, const Pace& pace);

  /// Holds a pointing finger in the middle of the picture, 0.09 m in front of the lens.
  /// @param frames  duration
  void pass_the_lens(double frames);

  /// Moves an open hand 0.15 to 0.22 m in front of the camera.
  /// @param frames  duration
  void work_in_front(double frames);

  /// Turns the hand before the camera about its forearm, which comes from the right: from palm down
  /// to palm up, and back. The camera then has seen all sides of what the hand holds. Returns false
  /// and adds nothing when the hand would touch desk or body.
  /// @param angle   rad, at least half a turn
  /// @param frames  duration of the turn back; the first one is faster
  bool turn_in_view(double angle, double frames);

  /// Keeps the hand at its rest position.
  void wait(double frames);

  /// The current end of the script, frames.
  [[nodiscard]] double now() const { return path_.keys.back().frame; }
  [[nodiscard]] const HandPath& path() const { return path_; }
  [[nodiscard]] const std::vector<PlannedTouch>& touches() const { return touches_; }
  [[nodiscard]] const std::vector<NamedSpan>& spans() const { return spans_; }
  /// Why the last press or slide that returned false was not possible.
  [[nodiscard]] const std::string& why_not() const { return why_not_; }

 private:
  void key(double at, const Eigen::Vector3d& tip, const Eigen::Quaterniond& turn, double open);
  bool touch(const PressPosture& posture, double depth, const Pace& pace,
             const std::vector<Eigen::Vector3d>& places);
  bool stays_clear(double start);
  bool touches_only(const PressPosture& posture, const std::vector<Eigen::Vector3d>& places,
                    FrameSpan frames, double start);

  const PressSearch& search_;
  const SurfacePoints& surface_;
  const PressStyle& style_;
  Eigen::Quaterniond rest_turn_;
  Eigen::Vector3d rest_;
  HandPath path_;
  std::vector<PlannedTouch> touches_;
  std::vector<NamedSpan> spans_;
  std::string why_not_ = "no place can be pressed as this sequence presses";
};

}  // namespace palpable
