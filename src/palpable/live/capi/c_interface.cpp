#include "palpable/common/body_file/touch_file.h"
#include "palpable/common/contact/touch.h"
#include "palpable/common/response/touchable_body.h"
#include "palpable/live/capi/c_session.h"
#include "palpable/live/capi/guarded.h"
#include "palpable/live/capi/image_input.h"
#include "palpable/live/capi/palpable.h"
#include "palpable/live/capi/setup.h"
#include "palpable/live/track/track_states.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

using palpable::Failure;
using palpable::guarded;
using palpable::hand_out;
using palpable::require;
using palpable::Rigid3;
using palpable::taken_in;

namespace {

constexpr std::size_t kMostBodies = 64;

// Sizes of the structs in version 0.1, the first one: no caller has smaller ones.
constexpr std::size_t kLeastSetup = offsetof(palpable_setup, full_resolution) + sizeof(int32_t);
constexpr std::size_t kLeastImage = offsetof(palpable_image, stride) + sizeof(size_t);
constexpr std::size_t kLeastFrame = offsetof(palpable_frame, left_to_go) + sizeof(double);
constexpr std::size_t kLeastTouch = offsetof(palpable_touch, unseen_for) + sizeof(double);
constexpr std::size_t kLeastSkin = offsetof(palpable_skin, stated_stress_error) + sizeof(double);
constexpr std::size_t kLeastDepth = offsetof(palpable_depth, cy) + sizeof(double);

const palpable_session& opened(const palpable_session* session) {
  require(session != nullptr, "session is null");
  if (session->is_broken) {
    throw Failure(PALPABLE_BROKEN,
                  "an earlier call broke off half way: reset or close the session");
  }
  return *session;
}

palpable_session& opened(palpable_session* session) {
  return const_cast<palpable_session&>(opened(static_cast<const palpable_session*>(session)));
}

palpable_session& opened_for(palpable_session* session,
                             std::optional<palpable::FrameFormat::Kind> of, const char* function) {
  palpable_session& open = opened(session);
  const bool fits = of ? open.camera && open.camera->format.kind == *of : !open.camera;
  if (!fits) {
    throw Failure(PALPABLE_NOT_POSSIBLE,
                  fmt::format("{} is for a session with another kind of camera", function));
  }
  return open;
}

palpable_image checked(const palpable_image* image, const char* what,
                       const palpable::FrameFormat& format, bool is_depth = false) {
  const palpable_image taken = taken_in(image, kLeastImage, what);
  if (const auto trouble =
          palpable::trouble_of(taken, what, format.width, format.height, is_depth)) {
    throw Failure(PALPABLE_WRONG_ARGUMENT, *trouble);
  }
  return taken;
}

// The time and the pose that a caller gives with a frame, after they were checked.
struct Moment {
  double time = 0;
  bool has_pose = false;
  std::optional<Rigid3> pose;
};

Moment checked_moment(const palpable_session& session, const double* world_from_camera,
                      double time) {
  require(std::isfinite(time) && std::abs(time) < 1e12, "time is no number of seconds");
  if (session.frames > 0 && !(time > session.time)) {
    throw Failure(
        PALPABLE_WRONG_ARGUMENT,
        fmt::format("time is {} s and that of the frame before was {} s", time, session.time));
  }
  Moment moment{time, world_from_camera != nullptr, {}};
  if (session.frames > 0 && moment.has_pose != session.gives_poses) {
    throw Failure(PALPABLE_WRONG_ARGUMENT,
                  "poses are to come with every frame since the first, or with none");
  }
  if (!moment.has_pose) return moment;
  require(!session.camera->session.track,
          "a session that follows the camera finds its poses, and is given none");
  if (!std::isnan(world_from_camera[0])) {
    moment.pose = palpable::pose_of(world_from_camera, "world_from_camera");
  }
  return moment;
}

// Processes session.images.
void process(palpable_session& session, const Moment& moment) {
  if (session.frames == 0) session.first_time = moment.time;
  session.images.number = session.frames;
  session.images.time = moment.time - session.first_time;
  session.gives_poses = moment.has_pose;
  session.process_images(moment.has_pose ? &moment.pose : nullptr);
  session.time = moment.time;
  ++session.frames;
}

bool is_near(const double x[3]) {
  constexpr double kFarthest = 1000;  // m; false for NaN
  return std::abs(x[0]) <= kFarthest && std::abs(x[1]) <= kFarthest && std::abs(x[2]) <= kFarthest;
}

bool is_radius(double r) { return r >= 1e-4 && r <= 100; }

int state_of(palpable::TrackState state) {
  switch (state) {
    case palpable::TrackState::kStarting:
      return PALPABLE_STARTING;
    case palpable::TrackState::kTracking:
      return PALPABLE_TRACKED;
    case palpable::TrackState::kLost:
      return PALPABLE_LOST;
    case palpable::TrackState::kFixed:
      break;
  }
  return PALPABLE_STANDS;
}

template <class Element>
std::size_t checked_index(int32_t index, const std::vector<Element>& among, const char* what) {
  if (index < 0 || static_cast<std::size_t>(index) >= among.size()) {
    throw Failure(PALPABLE_WRONG_ARGUMENT,
                  fmt::format("there is no {} {} among {}", what, index, among.size()));
  }
  return static_cast<std::size_t>(index);
}

void write(const Eigen::Vector3d& from, double to[3]) { Eigen::Vector3d::Map(to) = from; }

}  // namespace

const char* palpable_version(void) { return PALPABLE_VERSION; }

const char* palpable_last_error(void) { return palpable::last_failure(); }

palpable_status palpable_load_body(const char* path, double scale, palpable_body** body) {
  return guarded([&] {
    require(body != nullptr, "body is null");
    *body = nullptr;
    require(path != nullptr, "path is null");
    require(scale >= 1e-3 && scale <= 1e3, "scale is not within 0.001 and 1000");
    auto read = palpable::read_pressable_touchable_body(path);
    if (!read.ok()) throw Failure(PALPABLE_WRONG_FILE, read.problem().message);
    palpable::TouchableBody made = std::move(read).value();
    if (scale != 1) made = palpable::scaled(made, scale);
    auto handle = std::make_unique<palpable_body>();
    handle->body = std::make_shared<const palpable::TouchableBody>(std::move(made));
    *body = handle.release();
  });
}

palpable_status palpable_place_body(palpable_body* body, const double world_from_body[16]) {
  return guarded([&] {
    require(body != nullptr, "body is null");
    body->world_from_body = palpable::pose_of(world_from_body, "world_from_body");
  });
}

void palpable_free_body(palpable_body* body) { delete body; }

palpable_status palpable_open(const palpable_body* const* bodies, size_t count,
                              const palpable_setup* setup, palpable_session** session) {
  return guarded([&] {
    require(session != nullptr, "session is null");
    *session = nullptr;
    require(bodies != nullptr && count > 0, "a session has a body");
    require(count <= kMostBodies, "more than 64 bodies");
    std::vector<palpable_body> standing;
    for (std::size_t k = 0; k < count; ++k) {
      require(bodies[k] != nullptr, "one of the bodies is null");
      standing.push_back(*bodies[k]);
    }
    const palpable_setup wanted = taken_in(setup, kLeastSetup, "setup");
    std::optional<palpable::CameraSetup> camera;
    if (wanted.camera != PALPABLE_NO_CAMERA) camera = palpable::camera_setup(wanted);
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

palpable_status palpable_feed_stereo(palpable_session* session, const palpable_image* left,
                                     const palpable_image* right, const double* world_from_camera,
                                     double time) {
  return guarded([&] {
    palpable_session& open =
        opened_for(session, palpable::FrameFormat::Kind::kStereo, "palpable_feed_stereo");
    const palpable_image l = checked(left, "left image", open.camera->format);
    const palpable_image r = checked(right, "right image", open.camera->format);
    const Moment moment = checked_moment(open, world_from_camera, time);
    palpable::copy_color(l, open.images.left);
    palpable::copy_color(r, open.images.right);
    process(open, moment);
  });
}

palpable_status palpable_feed_depth(palpable_session* session, const palpable_image* depth,
                                    const palpable_image* color, const double* world_from_camera,
                                    double time) {
  return guarded([&] {
    palpable_session& open =
        opened_for(session, palpable::FrameFormat::Kind::kColorDepth, "palpable_feed_depth");
    const palpable::FrameFormat& format = open.camera->format;
    const palpable_image z = checked(depth, "depth image", format, true);
    std::optional<palpable_image> colors;
    if (color != nullptr) colors = checked(color, "colour image", format);
    require(colors || !open.camera->session.track, "following the camera takes colour images");
    const Moment moment = checked_moment(open, world_from_camera, time);
    palpable::copy_depth(z, open.images.depth);
    if (colors) {
      palpable::copy_color(*colors, open.images.left);
    } else {
      palpable::draw_depth(open.images.depth, open.images.left);
    }
    process(open, moment);
  });
}

palpable_status palpable_press(palpable_session* session, const palpable_capsule* capsules,
                               size_t count) {
  return guarded([&] {
    palpable_session& open = opened_for(session, std::nullopt, "palpable_press");
    require(capsules != nullptr || count == 0, "capsules is null");
    require(count <= palpable_session::kMostCapsules, "more than 4096 capsules");
    for (std::size_t k = 0; k < count; ++k) {
      const palpable_capsule& c = capsules[k];
      require(is_near(c.a) && is_near(c.b), "a capsule's end is not within 1000 m");
      require(is_radius(c.radius_a) && is_radius(c.radius_b),
              "a capsule's radius is not within 0.1 mm and 100 m");
    }
    open.process_capsules({capsules, count});
  });
}

palpable_status palpable_get_frame(const palpable_session* session, palpable_frame* frame) {
  return guarded([&] {
    const palpable_session& open = opened(session);
    const palpable::Scene& scene = open.scene();
    palpable_frame result{};
    result.time = open.time;
    result.body_count = static_cast<int32_t>(open.bodies.size());
    result.touch_count = static_cast<int32_t>(scene.touches.size());
    result.camera = open.camera && open.frames > 0 ? state_of(scene.camera.state) : PALPABLE_STANDS;
    result.wrong_pair = open.wrong_pair ? 1 : 0;
    palpable::write_pose(scene.camera.world_from_camera, result.world_from_camera);
    result.left_to_go = open.left_to_go;
    hand_out(result, kLeastFrame, frame, "frame");
  });
}

palpable_status palpable_get_touch(const palpable_session* session, int32_t index,
                                   palpable_touch* touch) {
  return guarded([&] {
    const std::vector<palpable::Touch>& touches = opened(session).scene().touches;
    const palpable::Touch& one = touches[checked_index(index, touches, "touch")];
    palpable_touch result{};
    result.body = one.body;
    result.by = one.by;
    write(one.point_in_body, result.point);
    write(-one.direction, result.normal);
    write(one.force * one.direction, result.force);
    result.depth = one.press_depth;
    result.area = one.area;
    result.assumed = one.assumed;
    result.unseen_for = one.unseen_for;
    hand_out(result, kLeastTouch, touch, "touch");
  });
}

palpable_status palpable_get_skin(const palpable_session* session, int32_t body,
                                  palpable_skin* skin) {
  return guarded([&] {
    const palpable_session& open = opened(session);
    const std::size_t k = checked_index(body, open.bodies, "body");
    const palpable::SceneBody& shown = open.scene().bodies[k];
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

palpable_status palpable_get_depth(const palpable_session* session, palpable_depth* depth) {
  return guarded([&] {
    const palpable_session& open = opened(session);
    if (!open.camera || open.frames == 0) {
      throw Failure(PALPABLE_NOT_POSSIBLE, "no camera has measured a depth yet");
    }
    const palpable::SeenFrame& seen = open.scene().seen;
    palpable_depth result{};
    result.width = seen.depth.width();
    result.height = seen.depth.height();
    result.depth = seen.depth.data();
    result.fx = seen.depth_camera.fx_px;
    result.fy = seen.depth_camera.fy_px;
    result.cx = seen.depth_camera.cx_px;
    result.cy = seen.depth_camera.cy_px;
    hand_out(result, kLeastDepth, depth, "depth");
  });
}
