/// @file
/// Forces at points of a skin as touches: neighbours that are pushed in the same direction are one.
///
/// Near a flat object few points take part (point_levels.h), each for a larger part of the skin.
/// Where a pressed point's nearest neighbour is s away, it stands for s^2, and neighbours are those
/// within 1.5 s.
#pragma once

#include "palpable/common/contact/obstacles.h"
#include "palpable/common/contact/touch.h"

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace palpable {

/// A point of the skin that is pressed, where it is now; body frame.
struct PressedPoint {
  Eigen::Vector3f place;  ///< m
  Eigen::Vector3f moved;  ///< m, since rest
  Eigen::Vector3f force;  ///< N
  float area = 0;         ///< m^2 of the skin that it stands for
  int by = -1;            ///< which other body presses it (Touch::by)
};

/// Keeps its memory.
class TouchPatches {
 public:
  /// @param most  points at a time, for which there is room from the start
  explicit TouchPatches(std::size_t most);

  /// To be filled before find().
  [[nodiscard]] std::vector<PressedPoint>& points() { return points_; }
  [[nodiscard]] const std::vector<PressedPoint>& points() const { return points_; }

  /// @param seen     what presses, other bodies apart; says which of it is assumed, or held. Null:
  ///                 all is measured
  /// @param touches  overwritten: the one with the largest force first
  void find(const Obstacles* seen, std::vector<Touch>& touches);
  /// m, after find(): from this point to the next one that is pushed the same way, at least as far
  /// as it stands for the skin itself.
  [[nodiscard]] float spacing(std::size_t point) const { return places_[point].spacing; }

 private:
  // Of a union-find forest.
  struct Place {
    int first = 0;
    int patch = 0;
    float spacing = 0;  // m, to the next one that is pushed the same way
    // Of what presses it, as SurfaceGap.
    Known known = Known::kMeasured;
    float unseen_for = 0;
  };
  [[nodiscard]] bool are_alike(int i, int j) const;
  void find_spacings();
  void join_neighbours();
  void find_known(const Obstacles* seen);
  [[nodiscard]] Touch touch_of(int patch) const;

  std::vector<PressedPoint> points_;
  std::vector<Place> places_;
  std::vector<Eigen::Vector3f> asked_;  // places of the points that something seen presses,
  std::vector<SurfaceGap> told_;        // and its gaps there
  int patches_ = 0;
};

}  // namespace palpable
