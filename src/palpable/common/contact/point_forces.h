/// @file
/// Forces at the contact points of a skin, and interpolation between the forces of two states.
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace palpable {

/// The force at one contact point.
struct PointForce {
  int point = 0;                                    ///< index into SkinPointSet::points
  Eigen::Vector3f force = Eigen::Vector3f::Zero();  ///< N, on the body, body frame
  int by = -1;  ///< which other body presses: its index in the solver; -1: an obstacle
  /// N, the part of the force that is friction (point_anchor.h: t)
  Eigen::Vector3f friction = Eigen::Vector3f::Zero();
};

/// Whether one force comes before another in a state's list: ordered by point, then by `by`.
[[nodiscard]] inline bool stands_before(const PointForce& a, const PointForce& b) {
  return a.point != b.point ? a.point < b.point : a.by < b.by;
}

/// Stores the forces with which a frame begins, so that the step limit can interpolate from them.
/// Allocates in its constructor.
class ForcesAtStart {
 public:
  /// @param most  forces of a state after limit_step(): the smallest ones are dropped
  explicit ForcesAtStart(std::size_t most);

  /// @pre at most as many forces as the constructor was given, in order
  void start(const std::vector<PointForce>& forces);
  /// forces <- begun + share (forces - begun), and friction likewise.
  void limit_step(std::vector<PointForce>& forces, float share);

 private:
  std::size_t most_;
  std::vector<PointForce> begun_, mixed_;
};

}  // namespace palpable
