#include "palpable/live/events/event_lines.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/json.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <iterator>
#include <string>

namespace palpable {
namespace {

constexpr std::string_view kStates[] = {"starting", "fixed", "tracking", "lost"};
static_assert(static_cast<int>(TrackState::kLost) == 3, "kStates has the states in their order");

Json list_of(const Eigen::Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

// With the same digits as in the lines of frames.
Json rows_of(const Rigid3& transform) {
  Json rows = Json::array();
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      rows.push_back(std::stod(fmt::format("{:.9g}", transform.matrix()(row, column))));
    }
  }
  return rows;
}

}  // namespace

std::vector<EventBody> event_bodies(const Session& session) {
  std::vector<EventBody> bodies;
  for (int k = 0; k < session.body_count(); ++k) {
    const SurfaceMesh& skin = session.body(k).model().surface;
    bodies.push_back({.name = session.body(k).name,
                      .world_from_body = session.body(k).world_from_body,
                      .vertices = static_cast<int>(skin.vertices.cols()),
                      .triangles = static_cast<int>(skin.triangles.cols()),
                      .low = skin.vertices.rowwise().minCoeff(),
                      .high = skin.vertices.rowwise().maxCoeff()});
  }
  return bodies;
}

std::string hello_line(const std::vector<EventBody>& bodies, EventWorld world) {
  Json listed = Json::array();
  for (const EventBody& body : bodies) {
    listed.push_back(Json{{"name", body.name},
                          {"world_from_body", rows_of(body.world_from_body)},
                          {"vertices", body.vertices},
                          {"triangles", body.triangles},
                          {"low", list_of(body.low)},
                          {"high", list_of(body.high)}});
  }
  const Json hello{{"type", "hello"},
                   {"format", "palpable touch events"},
                   {"version", 2},
                   {"units", Json{{"length", "m"}, {"force", "N"}, {"time", "s"}, {"area", "m^2"}}},
                   {"frames", Json{{"world", world == EventWorld::kFirstCamera
                                                 ? "the camera of the first frame"
                                                 : "the frame in which what presses is given"},
                                   {"camera", "X right, Y down, Z forward"},
                                   {"body", "that of the body's file"}}},
                   {"bodies", listed}};
  return hello.dump() + "\n";
}

EventLines::EventLines(const std::vector<EventBody>& bodies) {
  for (const EventBody& body : bodies) {
    names_.push_back(Json(body.name).dump());
    world_from_body_.push_back(body.world_from_body);
  }
}

std::string_view EventLines::line_of(const Scene& scene, const EventExtras& extras) {
  PALPABLE_EXPECT(scene.bodies.size() == names_.size(), "a scene of these bodies");
  text_.clear();
  fmt::format_to(std::back_inserter(text_),
                 "{{\"type\":\"frame\",\"frame\":{},\"time\":", scene.number);
  add_number(scene.time, 6);
  if (extras.skipped) fmt::format_to(std::back_inserter(text_), ",\"skipped\":{}", *extras.skipped);
  if (const std::string_view answer = text_of(scene.answer); !answer.empty()) {
    add(",\"answer\":\"");
    add(answer);
    add("\"");
  }
  add_camera(scene.camera);
  add(",\"bodies\":[");
  for (std::size_t k = 0; k < names_.size(); ++k) {
    if (k > 0) add(",");
    add_body(scene, static_cast<int>(k), extras.vertices);
  }
  add("]}\n");
  return text_;
}

std::string_view EventLines::tick_line(int frame, int tick, double time,
                                       std::span<const Touch> touches) {
  text_.clear();
  fmt::format_to(std::back_inserter(text_),
                 "{{\"type\":\"tick\",\"frame\":{},\"tick\":{},\"time\":", frame, tick);
  add_number(time, 6);
  add(",\"bodies\":[");
  for (std::size_t k = 0; k < names_.size(); ++k) {
    add(k > 0 ? ",{\"name\":" : "{\"name\":");
    add(names_[k]);
    add_touches(touches, {}, static_cast<int>(k));
    add("}");
  }
  add("]}\n");
  return text_;
}

void EventLines::add_number(double value, int decimals) {
  if (!std::isfinite(value)) return add("null");
  fmt::format_to(std::back_inserter(text_), "{:.{}f}", value, decimals);
}

void EventLines::add_vector(const Eigen::Vector3d& v) {
  add("[");
  for (int i = 0; i < 3; ++i) {
    if (i > 0) add(",");
    add_number(v[i], 6);
  }
  add("]");
}

void EventLines::add_rows(const Rigid3& transform) {
  if (!transform.matrix().allFinite()) return add("null");
  for (int i = 0; i < 16; ++i) {
    fmt::format_to(std::back_inserter(text_), "{}{:.9g}", i > 0 ? "," : "[",
                   transform.matrix()(i / 4, i % 4));
  }
  add("]");
}

void EventLines::add_camera(const TrackedPose& camera) {
  add(",\"camera\":{\"state\":\"");
  add(kStates[static_cast<std::size_t>(camera.state)]);
  add("\",\"world_from_camera\":");
  if (camera.state == TrackState::kLost) {
    add("null");
  } else {
    add_rows(camera.world_from_camera);
  }
  add(camera.new_world ? ",\"new_world\":true}" : ",\"new_world\":false}");
}

void EventLines::add_body(const Scene& scene, int number, bool vertices) {
  const auto k = static_cast<std::size_t>(number);
  const SceneBody& body = scene.bodies[k];
  add("{\"name\":");
  add(names_[k]);
  add(",\"world_from_body\":");
  add_rows(world_from_body_[k]);
  add(",\"camera_from_body\":");
  add_rows(body.camera_from_body);
  add_touches(scene.touches, scene.things, number);
  if (vertices) {
    add(",\"vertices\":[");
    for (Eigen::Index v = 0; v < body.vertices.cols(); ++v) {
      if (v > 0) add(",");
      add_vector(body.vertices.col(v).cast<double>());
    }
    add("]");
  }
  if (body.stated_error) {
    add(",\"displacement_error\":");
    add_number(body.stated_error->displacement, 5);
    add(",\"stress_error\":");
    add_number(body.stated_error->von_mises, 5);
  }
  add("}");
}

// Adds the touches on body `number` and skips those on other bodies.
void EventLines::add_touches(std::span<const Touch> touches, std::span<const std::int64_t> things,
                             int number) {
  add(",\"touches\":[");
  bool first = true;
  for (const Touch& touch : touches) {
    if (touch.body != number) continue;
    if (!first) add(",");
    first = false;
    add_touch(touch, things, world_from_body_[static_cast<std::size_t>(number)]);
  }
  add("]");
}

void EventLines::add_touch(const Touch& touch, std::span<const std::int64_t> things,
                           const Rigid3& world_from_body) {
  const Eigen::Vector3d force = touch.force * touch.direction;
  if (touch.site >= 0) {
    fmt::format_to(std::back_inserter(text_), "{{\"site\":{},\"level\":", touch.site);
    add_number(touch.level, 6);
    add(",\"press_depth\":");
  } else {
    add("{\"press_depth\":");
  }
  add_number(touch.press_depth, 7);
  add(",\"force\":");
  add_vector(force);
  add(",\"point\":");
  add_vector(touch.point_in_body);
  add(",\"normal\":");
  add_vector(touch.normal());
  if (!touch.friction.isZero(0)) {
    add(",\"friction\":");
    add_vector(touch.friction);
  }
  if (touch.site < 0) {
    add(",\"area\":");
    add_number(touch.area, 9);
    add(",\"assumed\":");
    add_number(touch.assumed, 4);
    if (touch.by >= 0) {
      add(",\"by\":");
      add(names_[static_cast<std::size_t>(touch.by)]);
    }
  }
  if (touch.thing >= 0 && static_cast<std::size_t>(touch.thing) < things.size()) {
    fmt::format_to(std::back_inserter(text_), ",\"thing\":{}",
                   things[static_cast<std::size_t>(touch.thing)]);
  }
  add(",\"unseen_for\":");
  add_number(touch.unseen_for, 6);
  if (touch.left_out > 0) {
    add(",\"left_out\":");
    add_number(touch.left_out, 0);
  }
  add(",\"world\":{\"point\":");
  add_vector(world_from_body * touch.point_in_body);
  add(",\"force\":");
  add_vector(world_from_body.linear() * force);
  add("}}");
}

}  // namespace palpable
