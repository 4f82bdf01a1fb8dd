/// @file
/// Into how many steps a truth with friction divides each frame of a clip: what slips within a step
/// slides in one direction, so a step is short against what moves along the skin. Capsules that
/// cannot touch the body in a frame do not count.
#pragma once

#include "palpable/common/geometry/tet_mesh.h"
#include "palpable/desk/clip_files/clip_hands.h"

#include <Eigen/Core>

#include <cstddef>

namespace palpable {

class FrameSteps {
 public:
  /// Both must outlive this object.
  FrameSteps(const ClipHands& hands, const TetMesh& mesh);

  /// The number of steps from the frame before to this one, >= 1. It is 1 where nothing moves that
  /// may touch the body.
  /// @param displacement  (3 x N) m, of the nodes at the frame before
  /// @param longest       m, how far a capsule may move in a step of the first walk
  /// @param shorter       number of steps into which each step of the first walk is divided
  [[nodiscard]] int count(int frame, const Eigen::Matrix3Xd& displacement, double longest,
                          int shorter) const;

 private:
  [[nodiscard]] double way_in_frame(int frame, const Eigen::Matrix3Xd& displacement) const;
  [[nodiscard]] double movement(int frame, std::size_t capsule) const;

  const ClipHands* hands_;
  const TetMesh* mesh_;
  Boundary boundary_;
  double edge_;  // m, the longest of the skin
};

}  // namespace palpable
