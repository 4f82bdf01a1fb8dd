#include "palpable/live/session/hidden_at_start.h"

#include <cmath>

namespace palpable {
namespace {

// An occluder is nearer than the vertex by the sum of these, m and sigmas of the measured depth.
// Smaller: noise, or a thing that touches the skin, counts as an occluder.
constexpr double kBefore = 0.01;
constexpr double kSigmas = 4;

}  // namespace

void HiddenAtStart::begin() {
  states_.clear();
  frames_ = hidden_ = 0;
}

double HiddenAtStart::look(const DepthImage& depth, const PinholeCamera& camera,
                           const DepthNoise& noise, const Eigen::Matrix3Xd& vertices,
                           const Rigid3& camera_from_body) {
  if (frames_ == 0) states_.assign(static_cast<std::size_t>(vertices.cols()), kUnknown);
  const bool may_hide = frames_ < kFrames;
  frames_ += may_hide ? 1 : 0;
  if (!may_hide && hidden_ == 0) return 0;
  for (Eigen::Index v = 0; v < vertices.cols(); ++v) {
    State& state = states_[static_cast<std::size_t>(v)];
    if (state == kSeen || (state == kUnknown && !may_hide)) continue;
    const Eigen::Vector3d at = camera_from_body * vertices.col(v);
    if (!(at.z() > 0)) continue;
    const Eigen::Vector2d px = camera.project(at);
    if (!(px.x() >= 0 && px.y() >= 0 && px.x() < depth.width() - 1 &&
          px.y() < depth.height() - 1)) {
      continue;
    }
    const auto Z = static_cast<double>(
        depth(static_cast<int>(std::lround(px.x())), static_cast<int>(std::lround(px.y()))));
    if (!(Z > 0)) continue;
    const bool hidden = Z < at.z() - kBefore - kSigmas * noise.sigma(Z);
    if (hidden == (state == kHidden)) {
      if (!hidden) state = kSeen;
      continue;
    }
    hidden_ += hidden ? 1 : -1;
    state = hidden ? kHidden : kSeen;
  }
  return vertices.cols() == 0 ? 0
                              : static_cast<double>(hidden_) / static_cast<double>(vertices.cols());
}

}  // namespace palpable
