#include "apps/palpable/scene_picture.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace palpable::app {
namespace {

// Part of the largest stress of all snapshots at which the colours end: the very largest stands at
// single vertices under a full press and would leave all else blue.
constexpr double kColorTop = 0.5;

// m behind the body up to which something counts as passing behind it, not as far background.
constexpr float kJustBehind = 0.3f;

}  // namespace

SceneView view_of(const Scene& scene, const Session& session) {
  SceneView view;
  view.background = &scene.seen->color;
  view.real_depth = &scene.seen->depth;
  view.camera = scene.seen->camera;
  BodyLook look;
  look.vertices = &scene.vertices;
  look.normals = &scene.normals;
  look.triangles = &session.body().surface.triangles;
  look.scalar = scene.von_mises;
  look.scalar_max = static_cast<float>(std::max(1.0, kColorTop * session.body().largest_von_mises));
  look.camera_from_body = session.camera_from_body();
  view.bodies.push_back(look);
  view.legend_title = "von Mises";
  if (scene.touches.empty()) {
    view.caption.push_back(fmt::format("{:.2f} s", scene.time));
  } else {
    const Touch& touch = scene.touches.front();
    view.caption.push_back(fmt::format("{:.2f} s   site {}   {:.1f} mm   {:.2f} N", scene.time,
                                       touch.site, touch.press_depth * 1e3, touch.force));
  }
  return view;
}

FigureScores figure_scores(const Scene& scene, const Session& session, const MaskImage& visible,
                           const DepthImage& body_depth, const DepthImage& pressing) {
  FigureScores scores;
  if (!scene.touches.empty()) {
    const Touch& touch = scene.touches.front();
    const Site& site = session.body().sites[static_cast<std::size_t>(touch.site)];
    const Eigen::Vector3d x =
        session.camera_from_body() * scene.vertices.col(site.vertex).cast<double>();
    const Eigen::Vector3d n =
        session.camera_from_body().linear() * scene.normals.col(site.vertex).cast<double>();
    // A press that one can look at: on the near side, with most of the body in view.
    std::int64_t seen = 0;
    for (const auto pixel : visible) seen += pixel != 0;
    scores.touch = touch.press_depth * (n.dot(x) < 0 ? 1.0 : 0.3) *
                   std::sqrt(static_cast<double>(seen) / static_cast<double>(visible.size()));
    return scores;
  }
  std::int64_t body = 0;
  std::int64_t hidden = 0;
  std::int64_t before_hand = 0;
  for (int y = 0; y < body_depth.height(); ++y) {
    const int py = std::min(y * pressing.height() / body_depth.height(), pressing.height() - 1);
    for (int x = 0; x < body_depth.width(); ++x) {
      const float z = body_depth(x, y);
      if (std::isnan(z)) continue;
      ++body;
      if (visible(x, y) == 0) {
        ++hidden;
        continue;
      }
      const int px = std::min(x * pressing.width() / body_depth.width(), pressing.width() - 1);
      const float real = pressing(px, py);
      before_hand += real > z && real < z + kJustBehind;  // false for NaN
    }
  }
  if (body == 0) return scores;
  // Best when half of the body is left: a body that is hidden altogether shows nothing.
  const double share = static_cast<double>(hidden) / static_cast<double>(body);
  scores.hand_nearer = std::min(share, 1 - share);
  scores.body_nearer = static_cast<double>(before_hand) / static_cast<double>(body);
  return scores;
}

}  // namespace palpable::app
