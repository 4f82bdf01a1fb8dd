#include "palpable/live/view/figure_scores.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace palpable {
namespace {

// m, the radius around a touch in which stress is summed.
constexpr float kAroundTouch = 0.04f;

// m: a presser up to this far behind the body counts as passing behind it; the rest is background.
constexpr float kJustBehind = 0.3f;

// The sum of the von Mises stress around a position, weighted by how much the skin faces the
// camera.
double stress_towards_camera(const SceneBody& body, const Eigen::Vector3f& place) {
  const Eigen::Matrix3f R = body.camera_from_body.linear().cast<float>();
  const Eigen::Vector3f t = body.camera_from_body.translation().cast<float>();
  double sum = 0;
  for (Eigen::Index k = 0; k < body.vertices.cols(); ++k) {
    const auto x = body.vertices.col(k);
    if ((x - place).norm() > kAroundTouch) continue;
    const float facing = -(R * body.normals.col(k)).dot((R * x + t).normalized());
    sum += static_cast<double>(std::max(0.0f, facing) * body.von_mises[k]);
  }
  return sum;
}

}  // namespace

FigureScores figure_scores(const Scene& scene, const Session& session, const MaskImage& visible,
                           const DepthImage& body_depth) {
  FigureScores scores;
  if (!scene.touches.empty()) {
    const Touch& touch = scene.touches.front();
    const SceneBody& body = scene.bodies[static_cast<std::size_t>(touch.body)];
    Eigen::Vector3f place = touch.point_in_body.cast<float>();
    if (touch.site >= 0) {
      place = body.vertices.col(session.body(touch.body).model().sites[touch.site].vertex);
    }
    scores.touch = stress_towards_camera(body, place);
    return scores;
  }
  std::int64_t pixels = 0;
  std::int64_t hidden = 0;
  std::int64_t before_hand = 0;
  const DepthImage& depth = scene.seen.depth;
  const MaskImage& shows = session.shows();
  for (int y = 0; y < body_depth.height(); ++y) {
    const int py = std::min(y * depth.height() / body_depth.height(), depth.height() - 1);
    for (int x = 0; x < body_depth.width(); ++x) {
      const float z = body_depth(x, y);
      if (std::isnan(z)) continue;
      ++pixels;
      if (visible(x, y) == 0) {
        ++hidden;
        continue;
      }
      const int px = std::min(x * depth.width() / body_depth.width(), depth.width() - 1);
      const float real = shows(px, py) == kShowsPresser ? depth(px, py) : 0;
      before_hand += real > z && real < z + kJustBehind;
    }
  }
  if (pixels == 0) return scores;
  // Largest when half of the body is hidden; 0 when all of it is.
  const double share = static_cast<double>(hidden) / static_cast<double>(pixels);
  scores.hand_nearer = std::min(share, 1 - share);
  scores.body_nearer = static_cast<double>(before_hand) / static_cast<double>(pixels);
  return scores;
}

}  // namespace palpable
