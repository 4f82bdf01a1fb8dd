#include "palpable/live/capi/c_session.h"

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/body_scale.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/response/touch_solver.h"
#include "palpable/live/capi/guarded.h"

#include <fmt/core.h>

#include <cstddef>
#include <utility>

using Eigen::Vector3d;
using palpable::Failure;

namespace {

palpable_answer answer_of(palpable::Reached reached) {
  switch (reached) {
    case palpable::Reached::kYes:
      return PALPABLE_REACHED;
    case palpable::Reached::kLater:
      return PALPABLE_LATER;
    case palpable::Reached::kNot:
      break;
  }
  return PALPABLE_NOT_REACHED;
}

}  // namespace

palpable_session::palpable_session(std::vector<palpable_body> the_bodies,
                                   std::unique_ptr<palpable::SessionCamera> the_camera)
    : bodies(std::move(the_bodies)), camera(std::move(the_camera)) {
  if (!camera) {
    for (const palpable_body& body : bodies) {
      if (body.body->touch) continue;
      throw Failure(PALPABLE_NOT_POSSIBLE,
                    fmt::format("body {} has no tables of touch: without a camera nothing else can "
                                "press it; bake it with tables (docs/body.md)",
                                body.body->body.name));
    }
  }
  reset();
}

void palpable_session::reset() {
  is_broken = true;  // until the reset is complete
  press_.reset();
  if (camera) {
    camera->restart(bodies);
  } else {
    std::vector<palpable::PressedBodies::Member> members;
    for (const palpable_body& body : bodies) {
      members.push_back({body.body, body.world_from_body, body.friction, body.dynamics});
    }
    press_ = std::make_unique<palpable::PressedBodies>(std::move(members));
    press_->keep({.contact_pressure = true});
    palpable::show_rest(bodies, shown_);
  }
  touches_.clear();
  things.clear();
  frames = 0;
  time = ticked_ = std::numeric_limits<double>::quiet_NaN();
  left_to_go = inside = ringing = 0;
  answer = PALPABLE_NOT_JUDGED;
  passed_through = 0;
  arrays_are_kept = false;
  is_broken = false;
}

palpable_kept_frame palpable_session::keep_frame() {
  std::vector<palpable::SceneBody>& from = camera ? camera->shown() : shown_;
  palpable_kept_frame kept{bodies, std::move(from), {}};
  if (camera) kept.depth = camera->take_depth();
  arrays_are_kept = true;
  from.clear();
  for (const palpable::SceneBody& one : kept.shown) {
    from.emplace_back().camera_from_body = one.camera_from_body;
  }
  return kept;
}

void palpable::require_scale(double scale) {
  if (is_scale(scale)) return;
  throw Failure(PALPABLE_WRONG_ARGUMENT,
                fmt::format("scale is {}, not within {} and {}", scale, kLeastScale, kMostScale));
}

std::unique_ptr<palpable_body> palpable::handle_of(TouchableBody body, double scale) {
  if (scale != 1) body = scaled(body, scale);
  auto handle = std::make_unique<palpable_body>();
  handle->body = std::make_shared<const TouchableBody>(std::move(body));
  return handle;
}

void palpable::show_rest(std::span<const palpable_body> bodies, std::vector<SceneBody>& shown) {
  shown.assign(bodies.size(), {});
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const SurfaceMesh& skin = bodies[k].body->body.surface;
    SceneBody& one = shown[k];
    one.camera_from_body = bodies[k].world_from_body;
    one.vertices = skin.vertices.cast<float>();
    one.normals.resize(3, skin.vertex_count());
    vertex_normals(one.vertices, skin.triangles, one.normals);
    one.von_mises.assign(static_cast<std::size_t>(skin.vertex_count()), 0.0f);
  }
}

void palpable_session::take_things(std::span<const palpable_thing> the_things) {
  capsules_.clear();
  for (const palpable_thing& thing : the_things) {
    for (std::size_t k = 0; k < thing.count; ++k) {
      const palpable_capsule& c = thing.capsules[k];
      capsules_.push_back({Vector3d(c.a), Vector3d(c.b), c.radius_a, c.radius_b});
    }
  }
  things_.clear();
  std::span<const palpable::Capsule> rest = capsules_;
  for (const palpable_thing& thing : the_things) {
    const float friction = thing.friction < 0    ? 0
                           : thing.friction == 0 ? palpable::kFrictionOfBody
                                                 : static_cast<float>(thing.friction);
    things_.push_back({thing.id, rest.first(thing.count), friction});
    rest = rest.subspan(thing.count);
  }
}

bool palpable_session::tick_things(std::span<const palpable_thing> the_things, double at,
                                   std::span<palpable::ThingForce> forces) {
  is_broken = true;
  take_things(the_things);
  const palpable::ContactReport report =
      press_->tick(things_, forces, is_first() ? 0.0 : at - last_time());
  ticked_ = at;
  is_broken = false;
  return !report.stuck && !(report.left_to_move > palpable::kReached);
}

void palpable_session::process_things(std::span<const palpable_thing> the_things, double at,
                                      bool moves) {
  is_broken = true;
  take_things(the_things);
  things.clear();
  for (const palpable_thing& thing : the_things) things.push_back(thing.id);
  std::optional<double> passed;
  if (moves) passed = is_first() ? 0.0 : at - last_time();
  const palpable::ContactReport report = press_->advance(things_, shown_, touches_, passed);
  ringing = report.ringing;
  left_to_go = report.left();
  inside = report.inside();
  answer = answer_of(report.reached());
  passed_through = press_->passed_through();
  ++frames;
  time = at;
  arrays_are_kept = false;
  is_broken = false;
}
