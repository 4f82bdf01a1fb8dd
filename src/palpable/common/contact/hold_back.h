/// @file
/// A frame whose answer lies farther away than a body may go in one frame: the state goes a share
/// of the way, in displacement and forces alike, and what is left is gone in the frames after.
#pragma once

#include "palpable/common/contact/touch_state.h"

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace palpable {

/// Allocates in its constructor.
class HoldBack {
 public:
  /// @param nodes, vertices  W and V of a state's displacement
  /// @param most_forces      of one that is held back: the least go first
  HoldBack(Eigen::Index nodes, Eigen::Index vertices, std::size_t most_forces);

  /// From where a frame begins. @pre a displacement of W columns, at most `most_forces` forces
  void start(const TouchState& state);
  /// Brings a state so far towards the beginning that no vertex has moved by more than
  /// `largest_move` (m). Returns what the one that moves farthest has yet to go, m; 0: the state
  /// is as it was.
  double bound(TouchState& state, double largest_move);

 private:
  Eigen::Index vertices_;
  std::size_t most_forces_;
  Eigen::Matrix3Xf began_;  // (3 x W) m
  std::vector<PointForce> forces_began_, mixed_;
};

}  // namespace palpable
