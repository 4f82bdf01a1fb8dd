/// @file
/// What is known of things from the frames before. A thing is followed as it moves (rigid_motion.h)
/// and what was seen of it moves along. Each ball of the frame before is then
///
///     seen again   it is where something is measured: the new ball is averaged with it, so that a
///                  hand that rests gives a surface that rests
///     hidden       its thing turned, and other parts of the thing are before it: it is kept, as
///                  large as the present outline allows
///     gone         the room is seen where it would be, or its thing lies farther back: free
///     unknown      neither: a hole of the matcher, something before it, out of the picture. It is
///                  held, so that a press does not drop to nothing for a frame without a
///                  measurement, and fades after a while
///
/// Body frame, m.
#pragma once

#include "palpable/contact/object_ball.h"
#include "palpable/contact/part_labels.h"
#include "palpable/contact/rigid_motion.h"
#include "palpable/contact/silhouette.h"

#include <cstddef>
#include <span>
#include <vector>

namespace palpable {

struct ObjectMemorySettings {
  double hold = 0.3;      ///< s for which an unknown ball stays as it was
  double fade = 0.3;      ///< s in which it then shrinks to nothing
  double remember = 3.0;  ///< s for which the side that a thing has turned away is kept
  int most_frames = 12;   ///< that are averaged; 1: none
  /// Balls that lie as near to each other across the view are the same: their share of the radius,
  /// and m.
  double same_share = 0.5;
  double same_least = 0.0015;
  /// Two measurements that differ by more sigmas of a single one are not averaged: the thing has
  /// changed.
  double same_sigmas = 3;
  double fattening = 0;  ///< px, as MedialBallSettings
  int most_balls = 4000;
  RigidMotionSettings motion{};
};

class ObjectMemory {
 public:
  explicit ObjectMemory(const ObjectMemorySettings& settings = {}) : settings_(settings) {}

  /// Averages `balls`, those of the frame at `time` (s), with those of the frame before, and adds
  /// the ones that are hidden or unknown now. Allocates nothing once there were as many.
  void merge(const FrontView& view, const Silhouette& silhouette, const PartLabels& parts,
             double time, std::vector<ObjectBall>& balls);

  void forget() { before_.clear(); }

 private:
  enum class Fate { kSeenAgain, kHidden, kGone, kUnknown };
  struct Part {
    Rigid3 step = Rigid3::Identity();  // now_from_before, of the last frame
    double time = 0;                   // s that it took
    bool followed = false;
  };

  void follow_parts(const FrontView& view, const PartLabels& parts, double passed);
  [[nodiscard]] int label_now(int part, const FrontView& view, const PartLabels& parts) const;
  void move(ObjectBall& ball) const;
  [[nodiscard]] Fate fate_of(ObjectBall& ball, const FrontView& view,
                             const Silhouette& silhouette) const;
  void average(const FrontView& view, std::span<ObjectBall> balls);
  void sort_into_cells(const FrontView& view, const PixelBox& box);

  ObjectMemorySettings settings_;
  double time_ = 0;
  std::vector<ObjectBall> before_;  // moved to where they are now
  std::size_t measured_before_ = 0;  // of them were measured in the frame before
  std::vector<Part> parts_;         // of the frame before, by its labels
  std::vector<Part> next_parts_;
  std::vector<FrontPoint> front_;
  std::vector<int> seen_again_;  // of before_
  // Cells of 4 x 4 px over the box: the first ball of before_ in each, and the next one of each.
  PixelBox box_;
  int cells_across_ = 0;
  std::vector<int> first_, next_;
};

}  // namespace palpable
