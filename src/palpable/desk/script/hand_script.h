/// @file
/// What one hand does during a sequence: it comes in, presses, goes back to its rest, and so on.
/// Each press is checked against the body's surface before it is kept.
#pragma once

#include "palpable/desk/script/desk_body.h"
#include "palpable/desk/script/hand_path.h"
#include "palpable/desk/script/press_search.h"
#include "palpable/desk/script/press_style.h"
#include "palpable/desk/script/sequence.h"

#include <cstdint>
#include <string>
#include <vector>

namespace palpable {

/// Where the tip is when the knuckles of the passing (open) hand are at a place.
/// @param turn  desk from wrist; the answer is in the frame of `knuckles`
[[nodiscard]] Eigen::Vector3d tip_for_knuckles(const HandTool& tool,
                                               const Eigen::Vector3d& knuckles,
                                               const Eigen::Quaterniond& turn);

/// Builds a hand's path and the list of its touches, one action after the other.
class HandScript {
 public:
  /// The hand comes in from the right and rests beside the body. All arguments but the seed must
  /// live as long as the script.
  /// @param surface  of the body that `search` looks at, desk frame
  /// @param seed     of the hand's tremor
  HandScript(const PressSearch& search, const SurfacePoints& surface, const PressStyle& style,
             std::uint64_t seed);

  /// How long the parts of a press last, frames: until the full depth, at the depth, back out.
  struct Pace {
    double in, hold, out;
  };

  /// Adds a press and the return to the rest. Adds nothing and returns false when on its way the
  /// hand would meet the desk, touch the body outside of the target's surroundings, or not touch it
  /// at all; why_not() then says which.
  bool press(const PressPosture& posture, double depth, const Pace& pace);

  /// As press(), but at the full depth the hand slides along the surface to another target. Also
  /// returns false where the surface in between has a fold that a finger cannot follow.
  bool slide(const PressPosture& from, const PressTarget& to, double depth, const Pace& pace);

  /// Holds a pointing finger in the middle of the picture, 0.09 m before the lens.
  /// @param frames  how long it stays there
  void pass_the_lens(double frames);

  /// An open hand works 0.15 to 0.22 m before the camera.
  /// @param frames  how long it works
  void work_in_front(double frames);

  /// The hand stays at its rest.
  void wait(double frames);

  /// The frame at which the script ends so far.
  [[nodiscard]] double now() const { return path_.keys.back().frame; }
  [[nodiscard]] const HandPath& path() const { return path_; }
  [[nodiscard]] const std::vector<PlannedTouch>& touches() const { return touches_; }
  [[nodiscard]] const std::vector<NamedSpan>& spans() const { return spans_; }
  /// Why the last refused press was refused.
  [[nodiscard]] const std::string& why_not() const { return why_not_; }

 private:
  void key(double at, const Eigen::Vector3d& tip, const Eigen::Quaterniond& turn, double open);
  bool touch(const PressPosture& posture, double depth, const Pace& pace,
             const std::vector<Eigen::Vector3d>& places);
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
