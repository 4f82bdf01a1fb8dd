/// @file
/// How steadily the drawn body keeps its position in the real world while the camera moves.
#pragma once

#include "palpable/common/geometry/rigid.h"

#include <optional>

namespace palpable {

/// Spread of the position at which the body's origin was drawn, in the real world:
///
///     p_n = world_from_camera_true(n) * camera_from_body_drawn(n) * 0
///     jitter = sqrt( mean over n of |p_n - mean p|^2 )
///
/// Slow drift and fast trembling both count; a body drawn at a wrong but constant position has no
/// jitter.
class AnchorScorer {
 public:
  void add(const Rigid3& true_world_from_camera, const Rigid3& drawn_camera_from_body);

  [[nodiscard]] int frames() const { return frames_; }
  /// m; nothing before the first frame.
  [[nodiscard]] std::optional<double> jitter() const;

 private:
  int frames_ = 0;
  Eigen::Vector3d mean_ = Eigen::Vector3d::Zero();
  double squares_ = 0;  ///< sum of |p - mean|^2, updated as in Welford 1962
};

}  // namespace palpable
