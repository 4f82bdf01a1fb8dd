/// @file
/// Forces at the contact points of a skin, and the way between those of two states.
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
};

/// Whether one force stands before another in a state's list: by point, then by what presses.
[[nodiscard]] inline bool stands_before(const PointForce& a, const PointForce& b) {
  return a.point != b.point ? a.point < b.point : a.by < b.by;
}

/// Remembers the forces with which a frame begins, to go back towards them. Allocates in its
/// constructor.
class ForcesAtStart {
 public:
  /// @param most  forces of a state that was held back: the least are dropped
  explicit ForcesAtStart(std::size_t most);

  /// @pre at most as many forces as the constructor was told, in order
  void start(const std::vector<PointForce>& forces);
  /// forces <- begun + share (forces - begun).
  void limit_step(std::vector<PointForce>& forces, float share);

 private:
  std::size_t most_;
  std::vector<PointForce> begun_, mixed_;
};

}  // namespace palpable
