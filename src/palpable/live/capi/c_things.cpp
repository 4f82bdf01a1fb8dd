// The C functions of sessions, of bodies and capsules: all but those that read body files and
// images (c_interface.cpp). They are also the core for web pages (web/).

#include "palpable/common/contact/touch.h"
#include "palpable/common/response/touch_tables.h"
#include "palpable/live/capi/c_checks.h"
#include "palpable/live/capi/c_session.h"
#include "palpable/live/capi/guarded.h"
#include "palpable/live/capi/palpable.h"
#include "palpable/live/capi/poses.h"
#include "palpable/live/capi/session_camera.h"
#include "palpable/live/things/thing_limits.h"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

using palpable::checked_index;
using palpable::Failure;
using palpable::guarded;
using palpable::hand_out;
using palpable::opened;
using palpable::opened_with_arrays;
using palpable::require;
using palpable::Rigid3;
using palpable::taken_in;

namespace {

constexpr std::size_t kMostBodies = 64;

// Sizes of the structs in version 0.1, the first one: no caller has smaller ones.
constexpr std::size_t kLeastSetup = offsetof(palpable_setup, full_resolution) + sizeof(int32_t);
constexpr std::size_t kLeastFrame = offsetof(palpable_frame, left_to_go) + sizeof(double);
constexpr std::size_t kLeastTouch = offsetof(palpable_touch, unseen_for) + sizeof(double);
constexpr std::size_t kLeastSkin = offsetof(palpable_skin, stated_stress_error) + sizeof(double);
constexpr std::size_t kLeastThing = offsetof(palpable_thing, count) + sizeof(size_t);

palpable_session& opened_without_camera(palpable_session* session, const char* function) {
  palpable_session& open = opened(session);
  palpable::require_kind(!open.camera, function);
  return open;
}

void check_capsule(const palpable_capsule& capsule, std::size_t index) {
  const auto refuse = [&](const char* what, double value, const std::string& bounds) {
    throw Failure(PALPABLE_WRONG_ARGUMENT,
                  fmt::format("capsule {}: {} is {} m, not within {}", index, what, value, bounds));
  };
  for (int k = 0; k < 3; ++k) {  // the comparisons are false for NaN
    for (const double x : {capsule.a[k], capsule.b[k]}) {
      if (std::abs(x) <= palpable::kFarthestThing) continue;
      refuse("a coordinate", x, fmt::format("{:g} m from 0", palpable::kFarthestThing));
    }
  }
  for (const double r : {capsule.radius_a, capsule.radius_b}) {
    if (r >= palpable::kLeastThingRadius && r <= palpable::kMostThingRadius) continue;
    refuse("a radius", r,
           fmt::format("{:g} mm and {:g} m", 1e3 * palpable::kLeastThingRadius,
                       palpable::kMostThingRadius));
  }
}

void require_at_most(std::size_t most, std::size_t count, const char* what) {
  if (count <= most) return;
  throw Failure(PALPABLE_WRONG_ARGUMENT, fmt::format("more than {} {}", most, what));
}

// A thing of a caller's list, whose structs may be larger or smaller than ours.
palpable_thing checked_thing(const palpable_thing* things, std::size_t index) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(things);
  const std::size_t stride = palpable::size_of_callers(things, kLeastThing, "thing 0");
  const auto* its = reinterpret_cast<const palpable_thing*>(bytes + index * stride);
  const std::string name = fmt::format("thing {}", index);
  if (its->size != stride) {
    throw Failure(PALPABLE_WRONG_ARGUMENT, name + ": size is not that of thing 0");
  }
  palpable_thing thing = taken_in(its, kLeastThing, name.c_str());
  if (thing.id == PALPABLE_NO_THING) {
    throw Failure(PALPABLE_WRONG_ARGUMENT, name + ": its id is PALPABLE_NO_THING");
  }
  if (thing.capsules == nullptr && thing.count > 0) {
    throw Failure(PALPABLE_WRONG_ARGUMENT, name + ": capsules is null");
  }
  if (thing.count > palpable::kMostThingCapsules) {
    throw Failure(PALPABLE_WRONG_ARGUMENT,
                  fmt::format("{}: more than {} capsules", name, palpable::kMostThingCapsules));
  }
  const bool has_none = thing.friction == PALPABLE_NO_FRICTION;
  if (!has_none && !palpable::is_friction(thing.friction)) {
    throw Failure(PALPABLE_WRONG_ARGUMENT,
                  fmt::format("{}: friction is {}, neither PALPABLE_NO_FRICTION nor within 0 and "
                              "{:g}",
                              name, thing.friction, palpable::kMostFriction));
  }
  for (std::size_t k = 0; k < thing.count; ++k) check_capsule(thing.capsules[k], k);
  return thing;
}

void check_together(std::span<const palpable_thing> things) {
  std::size_t capsules = 0;
  for (std::size_t k = 0; k < things.size(); ++k) {
    capsules += things[k].count;
    for (std::size_t j = 0; j < k; ++j) {
      if (things[j].id != things[k].id) continue;
      throw Failure(PALPABLE_WRONG_ARGUMENT,
                    fmt::format("things {} and {} have the same id {}", j, k, things[k].id));
    }
  }
  require_at_most(palpable::kMostThingCapsules, capsules, "capsules together");
}

// The things of a call that may be used.
class CheckedThings {
 public:
  CheckedThings(const palpable_thing* things, std::size_t count) : count_(count) {
    require(things != nullptr || count == 0, "things is null");
    require_at_most(palpable::kMostThings, count, "things");
    for (std::size_t k = 0; k < count; ++k) taken_[k] = checked_thing(things, k);
    check_together(all());
  }
  [[nodiscard]] std::span<const palpable_thing> all() const {
    return std::span(taken_).first(count_);
  }

 private:
  std::array<palpable_thing, palpable::kMostThings> taken_;
  std::size_t count_;
};

void write(const Eigen::Vector3d& from, double to[3]) { Eigen::Vector3d::Map(to) = from; }

}  // namespace

const char* palpable_version(void) { return PALPABLE_VERSION; }

const char* palpable_last_error(void) { return palpable::last_failure(); }

palpable_status palpable_place_body(palpable_body* body, const double world_from_body[16]) {
  return guarded([&] {
    require(body != nullptr, "body is null");
    body->world_from_body = palpable::pose_of(world_from_body, "world_from_body");
  });
}

palpable_status palpable_set_friction(palpable_body* body, double coefficient) {
  return guarded([&] {
    require(body != nullptr, "body is null");
    if (!palpable::is_friction(coefficient)) {
      throw Failure(PALPABLE_WRONG_ARGUMENT, fmt::format("coefficient is {}, not within 0 and {:g}",
                                                         coefficient, palpable::kMostFriction));
    }
    body->friction = coefficient;
  });
}

palpable_status palpable_set_dynamics(palpable_body* body, int32_t on) {
  return guarded([&] {
    require(body != nullptr, "body is null");
    body->dynamics = on != 0;
  });
}

void palpable_free_body(palpable_body* body) { delete body; }

palpable_status palpable_open(const palpable_body* const* bodies, size_t count,
                              const palpable_setup* setup, palpable_session** session) {
  return guarded([&] {
    require(session != nullptr, "session is null");
    *session = nullptr;
    require(bodies != nullptr && count > 0, "a session has a body");
    require_at_most(kMostBodies, count, "bodies");
    std::vector<palpable_body> standing;
    for (std::size_t k = 0; k < count; ++k) {
      require(bodies[k] != nullptr, "one of the bodies is null");
      standing.push_back(*bodies[k]);
    }
    const palpable_setup wanted = taken_in(setup, kLeastSetup, "setup");
    std::unique_ptr<palpable::SessionCamera> camera;
    if (wanted.camera != PALPABLE_NO_CAMERA) camera = palpable::camera_of(wanted);
    *session = std::make_unique<palpable_session>(std::move(standing), std::move(camera)).release();
  });
}

palpable_status palpable_reset(palpable_session* session) {
  return guarded([&] {
    require(session != nullptr, "session is null");
    session->reset();
  });
}

void palpable_close(palpable_session* session) { delete session; }

palpable_status palpable_press(palpable_session* session, const palpable_capsule* capsules,
                               size_t count) {
  return guarded([&] {
    palpable_session& open = opened_without_camera(session, "palpable_press");
    require(capsules != nullptr || count == 0, "capsules is null");
    require_at_most(palpable::kMostThingCapsules, count, "capsules");
    for (std::size_t k = 0; k < count; ++k) check_capsule(capsules[k], k);
    const palpable_thing thing{sizeof(palpable_thing), 0, capsules, count, PALPABLE_NO_FRICTION};
    open.process_things({&thing, 1}, open.is_first() ? 1 : open.last_time() + 1, false);
  });
}

palpable_status palpable_press_at(palpable_session* session, const palpable_thing* things,
                                  size_t count, double seconds) {
  return guarded([&] {
    palpable_session& open = opened_without_camera(session, "palpable_press_at");
    palpable::check_time(open, seconds);
    open.process_things(CheckedThings(things, count).all(), seconds, true);
  });
}

palpable_status palpable_tick_at(palpable_session* session, const palpable_thing* things,
                                 size_t count, double seconds, palpable_thing_force* forces,
                                 int32_t* reached) {
  return guarded([&] {
    palpable_session& open = opened_without_camera(session, "palpable_tick_at");
    palpable::check_time(open, seconds);
    require(forces != nullptr || count == 0, "forces is null");
    const CheckedThings checked(things, count);
    std::array<palpable::ThingForce, palpable::kMostThings> found;
    const bool is_answer = open.tick_things(checked.all(), seconds, std::span(found).first(count));
    if (reached != nullptr) *reached = is_answer ? 1 : 0;
    for (std::size_t k = 0; k < count; ++k) {
      write(found[k].force, forces[k].force);
      write(found[k].torque, forces[k].torque);
    }
  });
}

palpable_status palpable_get_frame(const palpable_session* session, palpable_frame* frame) {
  return guarded([&] {
    const palpable_session& open = opened(session);
    palpable_frame result{};
    result.time = open.time;
    result.body_count = static_cast<int32_t>(open.bodies.size());
    result.touch_count = static_cast<int32_t>(open.touches().size());
    result.camera = PALPABLE_STANDS;
    palpable::write_pose(Rigid3::Identity(), result.world_from_camera);
    if (open.camera) open.camera->describe(result);
    result.left_to_go = open.left_to_go;
    result.inside = open.inside;
    result.answer = open.answer;
    result.passed_through = open.passed_through;
    result.ringing = open.ringing;
    hand_out(result, kLeastFrame, frame, "frame");
  });
}

palpable_status palpable_get_touch(const palpable_session* session, int32_t index,
                                   palpable_touch* touch) {
  return guarded([&] {
    const palpable_session& open = opened(session);
    const std::vector<palpable::Touch>& touches = open.touches();
    const palpable::Touch& one = touches[checked_index(index, touches, "touch")];
    palpable_touch result{};
    result.body = one.body;
    result.by = one.by;
    write(one.point_in_body, result.point);
    write(one.normal(), result.normal);
    write(one.force * one.direction, result.force);
    result.depth = one.press_depth;
    result.area = one.area;
    result.assumed = one.assumed;
    result.unseen_for = one.unseen_for;
    result.left_out = one.left_out;
    const auto thing = static_cast<std::size_t>(one.thing);
    result.thing = one.thing >= 0 ? open.things.at(thing) : PALPABLE_NO_THING;
    hand_out(result, kLeastTouch, touch, "touch");
  });
}

palpable_status palpable_get_skin(const palpable_session* session, int32_t body,
                                  palpable_skin* skin) {
  return guarded([&] {
    const palpable_session& open = opened_with_arrays(session);
    const std::size_t k = checked_index(body, open.bodies, "body");
    const palpable::SceneBody& shown = open.shown()[k];
    const Eigen::Matrix3Xi& triangles = open.bodies[k].body->body.surface.triangles;
    palpable_skin result{};
    result.vertex_count = static_cast<int32_t>(shown.vertices.cols());
    result.triangle_count = static_cast<int32_t>(triangles.cols());
    result.vertices = shown.vertices.data();
    result.normals = shown.normals.data();
    result.von_mises = shown.von_mises.data();
    result.triangles = triangles.data();
    if (!shown.contact_pressure.empty()) result.contact_pressure = shown.contact_pressure.data();
    palpable::write_pose(open.bodies[k].world_from_body, result.world_from_body);
    palpable::write_pose(shown.camera_from_body, result.camera_from_body);
    constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
    result.stated_displacement_error =
        shown.stated_error ? shown.stated_error->displacement : kUnknown;
    result.stated_stress_error = shown.stated_error ? shown.stated_error->von_mises : kUnknown;
    hand_out(result, kLeastSkin, skin, "skin");
  });
}

palpable_status palpable_keep_frame(palpable_session* session, palpable_kept_frame** kept) {
  return guarded([&] {
    require(kept != nullptr, "kept is null");
    *kept = nullptr;
    palpable_session& open = opened(session);
    static_cast<void>(opened_with_arrays(session));
    *kept = std::make_unique<palpable_kept_frame>(open.keep_frame()).release();
  });
}

void palpable_free_kept_frame(palpable_kept_frame* kept) { delete kept; }
