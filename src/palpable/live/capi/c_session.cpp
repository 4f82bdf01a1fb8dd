#include "palpable/live/capi/c_session.h"

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/response/touch_solver.h"
#include "palpable/live/capi/guarded.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstddef>
#include <utility>

using Eigen::Vector3d;
using palpable::Failure;
using palpable::Rigid3;

palpable_session::palpable_session(std::vector<palpable_body> the_bodies,
                                   std::optional<palpable::CameraSetup> the_camera)
    : bodies(std::move(the_bodies)), camera(std::move(the_camera)) {
  if (!camera) {
    if (bodies.size() != 1) {
      throw Failure(PALPABLE_NOT_POSSIBLE, "a session without a camera has one body");
    }
    if (!bodies.front().body->touch) {
      throw Failure(PALPABLE_NOT_POSSIBLE,
                    fmt::format("body {} has no tables of touch: without a camera nothing else can "
                                "press it; bake it with tables (docs/body.md)",
                                bodies.front().body->body.name));
    }
  }
  reset();
}

void palpable_session::reset() {
  is_broken = true;  // until the reset is complete
  loop_.reset();
  press_.reset();
  pressed_ = {};
  images = {};
  if (camera) {
    std::vector<palpable::PlacedBody> placed;
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      placed.push_back({*bodies[k].body, bodies[k].world_from_body, fmt::format("{}", k)});
    }
    auto loop = palpable::FrameLoop::make(std::move(placed), camera->format, camera->session);
    if (!loop.ok()) throw Failure(PALPABLE_WRONG_ARGUMENT, loop.problem().message);
    loop_.emplace(std::move(loop).value());
    loop_->session.keep({.contact_pressure = true});
    show_rest(loop_->scene);
  } else {
    press_ = std::make_unique<palpable::CapsulePress>(bodies.front().body);
    press_->keep({.contact_pressure = true});
    show_rest(pressed_);
  }
  frames = 0;
  first_time = 0;
  time = std::numeric_limits<double>::quiet_NaN();
  gives_poses = wrong_pair = false;
  left_to_go = 0;
  is_broken = false;
}

void palpable_session::show_rest(palpable::Scene& scene) const {
  scene.bodies.resize(bodies.size());
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const palpable::SurfaceMesh& skin = bodies[k].body->body.surface;
    palpable::SceneBody& shown = scene.bodies[k];
    shown.camera_from_body = bodies[k].world_from_body;
    shown.vertices = skin.vertices.cast<float>();
    shown.normals.resize(3, skin.vertex_count());
    palpable::vertex_normals(shown.vertices, skin.triangles, shown.normals);
    shown.von_mises.assign(static_cast<std::size_t>(skin.vertex_count()), 0.0f);
  }
}

void palpable_session::process_images(const std::optional<Rigid3>* pose) {
  is_broken = true;
  const palpable::Scene& scene =
      pose != nullptr ? loop_->process(images, *pose) : loop_->process(images);
  wrong_pair |= scene.seen.misfit.has_value();
  is_broken = false;
}

void palpable_session::process_capsules(std::span<const palpable_capsule> capsules) {
  is_broken = true;
  const Rigid3 body_from_world = bodies.front().world_from_body.inverse();
  in_body_.clear();
  for (const palpable_capsule& c : capsules) {
    in_body_.push_back(
        {body_from_world * Vector3d(c.a), body_from_world * Vector3d(c.b), c.radius_a, c.radius_b});
  }
  const palpable::TouchReport report =
      press_->advance(in_body_, pressed_.bodies.front(), pressed_.touches);
  left_to_go = std::max(report.left_to_move, report.penetration);
  ++frames;
  time = frames;
  is_broken = false;
}
