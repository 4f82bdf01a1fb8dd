#include "palpable/live/view/camera_path.h"

namespace palpable {
namespace {

constexpr std::size_t kMost = 4096;  // points, see CameraPath
constexpr Rgb kColor{28, 84, 222};
constexpr float kPathWidth = 3.5f;  // px

}  // namespace

void CameraPath::add(const TrackedPose& camera) {
  if (!is_known(camera)) {
    now_.reset();
    return;
  }
  const Rigid3& pose = camera.world_from_camera;
  // Closing a loop makes the pose jump, which is no motion of the camera.
  const bool continues = now_.has_value() && !camera.closed_loop;
  now_ = pose;
  if (continues && (poses_.back().translation() - pose.translation()).norm() < step_) return;
  if (poses_.size() == kMost) thin();
  poses_.push_back(pose);
  continues_.push_back(continues);
}

// Drops every second point, but keeps both ends of each stretch without a gap.
void CameraPath::thin() {
  step_ *= 2;
  std::size_t kept = 0;
  bool drop = false;
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    const bool ends = i + 1 == poses_.size() || !continues_[i + 1];
    drop = continues_[i] && !ends && !drop;
    if (drop) continue;
    poses_[kept] = poses_[i];
    continues_[kept] = continues_[i];
    ++kept;
  }
  poses_.resize(kept);
  continues_.resize(kept);
}

void CameraPath::draw(std::vector<MapLine>& lines) const {
  for (std::size_t i = 1; i < poses_.size(); ++i) {
    if (!continues_[i]) continue;
    lines.push_back({poses_[i - 1].translation().cast<float>(),
                     poses_[i].translation().cast<float>(), kColor, kPathWidth});
  }
  if (now_) {
    lines.push_back({poses_.back().translation().cast<float>(), now_->translation().cast<float>(),
                     kColor, kPathWidth});
  }
}

}  // namespace palpable
