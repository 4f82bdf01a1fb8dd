#include "palpable/desk/score/anchor_score.h"

#include <cmath>

namespace palpable {

void AnchorScorer::add(const Rigid3& true_world_from_camera, const Rigid3& drawn_camera_from_body) {
  const Eigen::Vector3d p = true_world_from_camera * drawn_camera_from_body.translation();
  ++frames_;
  const Eigen::Vector3d from_old_mean = p - mean_;
  mean_ += from_old_mean / frames_;
  squares_ += from_old_mean.dot(p - mean_);
}

std::optional<double> AnchorScorer::jitter() const {
  if (frames_ == 0) return std::nullopt;
  return std::sqrt(squares_ / frames_);
}

}  // namespace palpable
