#include "palpable/view/scene_picture.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpable {

namespace {

constexpr double kSameGround = 0.003;  // m

bool stands_on_first_ground(const Session& session, int number) {
  const Rigid3 first_from_body =
      session.world_from_body().inverse() * session.world_from_body(number);
  return std::abs(first_from_body.translation().z()) < kSameGround &&
         first_from_body.linear()(2, 2) > 0.999;
}

}  // namespace

BodyLook look_of_body(const Scene& scene, const Session& session, int number, double scale) {
  const SceneBody& shown = scene.bodies[static_cast<std::size_t>(number)];
  BodyLook look;
  look.vertices = &shown.vertices;
  look.normals = &shown.normals;
  look.triangles = &session.body(number).surface.triangles;
  look.scalar = shown.von_mises;
  look.scalar_max = static_cast<float>(scale);
  look.camera_from_body = shown.camera_from_body;
  look.color = session.color(number);
  if (!stands_on_first_ground(session, number)) look.shadow = 0;
  return look;
}

std::string caption_of(const Scene& scene) {
  if (scene.touches.empty()) return fmt::format("{:.2f} s", scene.time);
  std::string text = fmt::format("{:.2f} s   {}", scene.time, caption_of(scene.touches));
  // Of several bodies what the one says that is known worst.
  double displacement = 0, stress = 0;
  bool stated = false;
  for (const SceneBody& body : scene.bodies) {
    if (!body.stated_error) continue;
    displacement = std::max(displacement, body.stated_error->displacement);
    stress = std::max(stress, body.stated_error->von_mises);
    stated = true;
  }
  if (stated) {
    text += fmt::format("   for what is seen off by some {:.2g} %, stress {:.2g} %",
                        100 * displacement, 100 * stress);
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

void fill_view(const Scene& scene, const Session& session, double scale, const SceneShow& show,
               SceneView& view) {
  view.background = &scene.seen.color;
  view.real_depth = show.occlusion ? &scene.seen.depth : nullptr;
  view.camera = scene.seen.camera;
  view.bodies.clear();
  for (int k = 0; k < session.body_count(); ++k) {
    view.bodies.push_back(look_of_body(scene, session, k, scale));
  }
  view.legend_title = show.legend ? "von Mises" : "";
  view.caption.resize(1);
  view.caption.front() = caption_of(scene);
  view.warning = warning_of(scene);
}

}  // namespace palpable
