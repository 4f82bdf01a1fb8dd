/// @file
/// A touch of a body: the list of touches passes from contact to reconstruction, scene and files.
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <span>
#include <utility>

namespace palpable {

/// One contact patch of a body, with its force. Body frame.
struct Touch {
  int site = -1;           ///< index into ReducedBody::sites; -1: anywhere, at point_in_body
  double level = 0;        ///< (0, 1] of the site's full load: the paper's pseudo-time; 0: no site
  double force = 0;        ///< N, norm of the sum of its forces
  double press_depth = 0;  ///< m, largest displacement of the skin there against its normal
  Eigen::Vector3d point_in_body = Eigen::Vector3d::Zero();  ///< m, centre of pressure
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();      ///< unit, of the force on the body
  double unseen_for = 0;  ///< s since the obstacle was measured (held_balls.h); 0: in this frame
  double area = 0;        ///< m^2 of the pressed skin; 0: not known, as at a site
  /// Share of the force by parts of the obstacle that were not measured in this frame, such as its
  /// far side.
  double assumed = 0;
  int body = 0;  ///< which of the scene's bodies (Scene::bodies)
  int by = -1;   ///< index of the other body that presses it; -1: an obstacle
  /// Which of several obstacles presses it (SurfaceGap::thing); -1: not known, or another body.
  int thing = -1;
  /// N, the part of the force that is friction, on the body; 0 without friction.
  Eigen::Vector3d friction = Eigen::Vector3d::Zero();
  double coefficient = 0;  ///< of friction, between the body and what presses it
  /// Whether what presses is taken to move as its thing does in the mean, since a camera does not
  /// see how it moves there (ObjectBall::way_is_mean). False without friction.
  bool way_is_mean = false;
  /// Contact points near what presses the body for which there was no room: the nearest ones took
  /// part, and the force is theirs.
  int left_out = 0;

  /// N, the whole force on the body.
  [[nodiscard]] Eigen::Vector3d whole_force() const { return force * direction; }
  /// Unit, out of the body: against the part of the force that is not friction. Without friction
  /// that is -direction, to the bit.
  [[nodiscard]] Eigen::Vector3d normal() const {
    if (friction.isZero(0)) return -direction;
    return (friction - whole_force()).normalized();
  }
};

/// Sorts touches by force, the largest first; equal ones keep their order. Few of them, so that an
/// insertion sort will do: std::stable_sort would allocate.
inline void sort_by_force(std::span<Touch> touches) {
  for (std::size_t k = 1; k < touches.size(); ++k) {
    for (std::size_t j = k; j > 0 && touches[j - 1].force < touches[j].force; --j) {
      std::swap(touches[j - 1], touches[j]);
    }
  }
}

}  // namespace palpable
