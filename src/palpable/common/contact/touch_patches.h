/// @file
/// Combines forces at points of a skin into touches: neighbouring points that the same thing pushes
/// in the same direction form one contact patch.
///
/// Near a flat obstacle few points take part (point_levels.h), each for a larger part of the skin.
/// A pressed point whose nearest neighbour is s away stands for an area s^2, and points within 1.5
/// s are neighbours.
#pragma once

#include "palpable/common/contact/obstacles.h"
#include "palpable/common/contact/touch.h"

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace palpable {

/// A pressed point of the skin in the present shape; body frame.
struct PressedPoint {
  Eigen::Vector3f place;  ///< m
  Eigen::Vector3f moved;  ///< m, its displacement
  Eigen::Vector3f force;  ///< N
  float area = 0;         ///< m^2 of the skin that it stands for
  int by = -1;            ///< Touch::by
  /// N, the part of the force that is friction
  Eigen::Vector3f friction = Eigen::Vector3f::Zero();
};

/// Keeps its memory.
class TouchPatches {
 public:
  /// @param most  points at a time, for which there is room from the start
  explicit TouchPatches(std::size_t most);

  /// To be filled before find().
  [[nodiscard]] std::vector<PressedPoint>& points() { return points_; }
  [[nodiscard]] const std::vector<PressedPoint>& points() const { return points_; }

  /// @param seen     the obstacles without other bodies; they tell which part of them is assumed or
  ///                 held. Null: all is measured
  /// @param touches  overwritten: the one with the largest force first
  void find(const Obstacles* seen, std::vector<Touch>& touches);
  /// m, after find(): the spacing of a point, its distance from the nearest one that is pushed the
  /// same way, and at least the root of its own area.
  [[nodiscard]] float spacing(std::size_t point) const { return places_[point].spacing; }

 private:
  // A node of a union-find forest.
  struct Place {
    int first = 0;
    int patch = 0;
    float spacing = 0;  // m, see spacing()
    // Of the obstacle, as in SurfaceGap.
    Known known = Known::kMeasured;
    float unseen_for = 0;
    int thing = -1;
  };
  [[nodiscard]] bool are_alike(int i, int j) const;
  void find_spacings();
  void join_neighbours();
  void find_known(const Obstacles* seen);
  [[nodiscard]] Touch touch_of(int patch) const;

  std::vector<PressedPoint> points_;
  std::vector<Place> places_;
  std::vector<Eigen::Vector3f> queried_;  // positions of the points that obstacles press,
  std::vector<SurfaceGap> gaps_;          // and the gaps there
  int patches_ = 0;
};

}  // namespace palpable
