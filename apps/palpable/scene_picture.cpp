#include "apps/palpable/scene_picture.h"

#include "palpable/base/order_statistics.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace palpable::app {
namespace {

// m around a pressed site: whose stress the picture of a touch is to show.
constexpr float kAroundSite = 0.04f;

// m behind the body up to which something counts as passing behind it, not as far background.
constexpr float kJustBehind = 0.3f;

}  // namespace

double stress_scale(const ReducedBody& body) {
  const auto V = static_cast<std::size_t>(body.surface.vertices.cols());
  std::vector<float> stress(6 * V);
  std::vector<float> mises(V);
  std::vector<double> per_site;
  for (std::size_t s = 0; s < body.sites.size(); ++s) {
    body.stress.evaluate(std::array{static_cast<double>(s), 1.0}, stress);
    von_mises(stress, mises);
    per_site.push_back(percentile(std::vector<double>(mises.begin(), mises.end()), 0.99));
  }
  return std::max(percentile(per_site, 0.75), 1.0);
}

BodyLook look_of_body(const Scene& scene, const Session& session, double scale) {
  BodyLook look;
  look.vertices = &scene.vertices;
  look.normals = &scene.normals;
  look.triangles = &session.body().surface.triangles;
  look.scalar = scene.von_mises;
  look.scalar_max = static_cast<float>(scale);
  look.camera_from_body = scene.camera_from_body;
  return look;
}

std::string caption_of(const Scene& scene) {
  if (scene.touches.empty()) return fmt::format("{:.2f} s", scene.time);
  const Touch& touch = scene.touches.front();
  return fmt::format("{:.2f} s   site {}   {:.1f} mm   {:.2f} N", scene.time, touch.site,
                     touch.press_depth * 1e3, touch.force);
}

std::string warning_of(const Scene& scene) {
  if (scene.camera.state != TrackState::kLost) return {};
  if (scene.camera.newest_keyframe < 0)
    return "Camera not placed yet: show it a place with texture";
  return "Camera lost: show it what it has seen before";
}

SceneView view_of(const Scene& scene, const Session& session, double scale) {
  SceneView view;
  view.background = &scene.seen.color;
  view.real_depth = &scene.seen.depth;
  view.camera = scene.seen.camera;
  view.bodies.push_back(look_of_body(scene, session, scale));
  view.legend_title = "von Mises";
  view.caption.push_back(caption_of(scene));
  view.warning = warning_of(scene);
  return view;
}

FigureScores figure_scores(const Scene& scene, const Session& session, const MaskImage& visible,
                           const DepthImage& body_depth, const DepthImage& pressing) {
  FigureScores scores;
  if (!scene.touches.empty()) {
    const Touch& touch = scene.touches.front();
    const Site& site = session.body().sites[static_cast<std::size_t>(touch.site)];
    // The stress around the site that faces the camera.
    const Eigen::Matrix3f R = scene.camera_from_body.linear().cast<float>();
    const Eigen::Vector3f t = scene.camera_from_body.translation().cast<float>();
    for (Eigen::Index k = 0; k < scene.vertices.cols(); ++k) {
      const auto x = scene.vertices.col(k);
      if ((x - scene.vertices.col(site.vertex)).norm() > kAroundSite) continue;
      const float facing = -(R * scene.normals.col(k)).dot((R * x + t).normalized());
      scores.touch += static_cast<double>(std::max(0.0f, facing) *
                                          scene.von_mises[static_cast<std::size_t>(k)]);
    }
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
