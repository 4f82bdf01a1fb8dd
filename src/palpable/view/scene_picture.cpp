#include "palpable/view/scene_picture.h"

#include <fmt/core.h>

#include <algorithm>

namespace palpable {

BodyLook look_of_body(const Scene& scene, const ReducedBody& body, double scale) {
  BodyLook look;
  look.vertices = &scene.vertices;
  look.normals = &scene.normals;
  look.triangles = &body.surface.triangles;
  look.scalar = scene.von_mises;
  look.scalar_max = static_cast<float>(scale);
  look.camera_from_body = scene.camera_from_body;
  return look;
}

std::string caption_of(const Scene& scene) {
  if (scene.touches.empty()) return fmt::format("{:.2f} s", scene.time);
  std::string text = fmt::format("{:.2f} s   {}", scene.time, caption_of(scene.touches));
  if (scene.stated_error) {
    text +=
        fmt::format("   for what is seen off by some {:.2g} %, stress {:.2g} %",
                    100 * scene.stated_error->displacement, 100 * scene.stated_error->von_mises);
  }
  return text;
}

std::string caption_of(std::span<const Touch> touches) {
  if (touches.empty()) return "not touched";
  double deepest = 0, force = 0;
  for (const Touch& touch : touches) {
    deepest = std::max(deepest, touch.press_depth);
    force += touch.force;
  }
  std::string text;
  if (touches.front().site >= 0) text = fmt::format("site {}   ", touches.front().site);
  if (touches.size() > 1) text = fmt::format("{} touches   ", touches.size());
  return text + fmt::format("{:.1f} mm   {:.2f} N", deepest * 1e3, force);
}

std::string warning_of(const Scene& scene) {
  if (scene.camera.state == TrackState::kLost) {
    if (scene.camera.newest_keyframe < 0)
      return "Camera not placed yet: show it a place with texture";
    return "Camera lost: show it what it has seen before";
  }
  for (const Touch& touch : scene.touches) {
    if (touch.unseen_for > 0) return "What presses is not seen at present: its last place is held";
  }
  return {};
}

SceneView view_of(const Scene& scene, const ReducedBody& body, double scale) {
  SceneView view;
  view.background = &scene.seen.color;
  view.real_depth = &scene.seen.depth;
  view.camera = scene.seen.camera;
  view.bodies.push_back(look_of_body(scene, body, scale));
  view.legend_title = "von Mises";
  view.caption.push_back(caption_of(scene));
  view.warning = warning_of(scene);
  return view;
}

}  // namespace palpable
