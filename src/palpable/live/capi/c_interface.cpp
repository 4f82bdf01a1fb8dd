// The C functions that read body files and images.

#include "palpable/common/body_file/touch_file.h"
#include "palpable/common/response/touchable_body.h"
#include "palpable/live/capi/c_checks.h"
#include "palpable/live/capi/c_session.h"
#include "palpable/live/capi/guarded.h"
#include "palpable/live/capi/image_input.h"
#include "palpable/live/capi/loop_camera.h"
#include "palpable/live/capi/palpable.h"
#include "palpable/live/capi/poses.h"

#include <fmt/core.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

using palpable::Failure;
using palpable::guarded;
using palpable::hand_out;
using palpable::require;
using palpable::Rigid3;
using palpable::taken_in;

namespace {

// Sizes of the structs in version 0.1, the first one: no caller has smaller ones.
constexpr std::size_t kLeastImage = offsetof(palpable_image, stride) + sizeof(size_t);
constexpr std::size_t kLeastDepth = offsetof(palpable_depth, cy) + sizeof(double);

// A session with a camera, and the camera.
struct Seeing {
  palpable_session& session;
  palpable::LoopCamera& camera;
};

// In this library every camera is camera_of()'s.
palpable::LoopCamera& seeing(const palpable_session& session) {
  return static_cast<palpable::LoopCamera&>(*session.camera);
}

Seeing opened_for(palpable_session* session, palpable::FrameFormat::Kind of, const char* function) {
  palpable_session& open = palpable::opened(session);
  palpable::require_kind(open.camera && seeing(open).setup.format.kind == of, function);
  return {open, seeing(open)};
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

Moment checked_moment(const Seeing& open, const double* world_from_camera, double time) {
  palpable::check_time(open.session, time);
  Moment moment{time, world_from_camera != nullptr, {}};
  if (open.session.frames > 0 && moment.has_pose != open.camera.gives_poses) {
    throw Failure(PALPABLE_WRONG_ARGUMENT,
                  "poses are to come with every frame since the first, or with none");
  }
  if (!moment.has_pose) return moment;
  require(!open.camera.setup.session.track,
          "a session that follows the camera finds its poses, and is given none");
  if (!std::isnan(world_from_camera[0])) {
    moment.pose = palpable::pose_of(world_from_camera, "world_from_camera");
  }
  return moment;
}

// Processes camera.images.
void process(const Seeing& open, const Moment& moment) {
  auto& [session, camera] = open;
  if (session.frames == 0) camera.first_time = moment.time;
  camera.images.number = session.frames;
  camera.images.time = moment.time - camera.first_time;
  camera.gives_poses = moment.has_pose;
  session.is_broken = true;
  camera.process_images(moment.has_pose ? &moment.pose : nullptr);
  session.inside = camera.scene().inside;
  session.arrays_are_kept = false;
  session.is_broken = false;
  session.time = moment.time;
  ++session.frames;
}

}  // namespace

palpable_status palpable_load_body(const char* path, double scale, palpable_body** body) {
  return guarded([&] {
    require(body != nullptr, "body is null");
    *body = nullptr;
    require(path != nullptr, "path is null");
    palpable::require_scale(scale);
    auto read = palpable::read_pressable_touchable_body(path);
    if (!read.ok()) throw Failure(PALPABLE_WRONG_FILE, read.problem().message);
    *body = palpable::handle_of(std::move(read).value(), scale).release();
  });
}

palpable_status palpable_feed_stereo(palpable_session* session, const palpable_image* left,
                                     const palpable_image* right, const double* world_from_camera,
                                     double time) {
  return guarded([&] {
    Seeing open = opened_for(session, palpable::FrameFormat::Kind::kStereo, "palpable_feed_stereo");
    const palpable_image l = checked(left, "left image", open.camera.setup.format);
    const palpable_image r = checked(right, "right image", open.camera.setup.format);
    const Moment moment = checked_moment(open, world_from_camera, time);
    palpable::copy_color(l, open.camera.images.left);
    palpable::copy_color(r, open.camera.images.right);
    process(open, moment);
  });
}

palpable_status palpable_feed_depth(palpable_session* session, const palpable_image* depth,
                                    const palpable_image* color, const double* world_from_camera,
                                    double time) {
  return guarded([&] {
    Seeing open =
        opened_for(session, palpable::FrameFormat::Kind::kColorDepth, "palpable_feed_depth");
    const palpable::FrameFormat& format = open.camera.setup.format;
    const palpable_image z = checked(depth, "depth image", format, true);
    std::optional<palpable_image> colors;
    if (color != nullptr) colors = checked(color, "colour image", format);
    require(colors || !open.camera.setup.session.track, "following the camera takes colour images");
    const Moment moment = checked_moment(open, world_from_camera, time);
    if (const auto doubt = palpable::doubt_about_unit(z)) {
      throw Failure(PALPABLE_WRONG_ARGUMENT, *doubt);
    }
    palpable::copy_depth(z, open.camera.images.depth);
    if (colors) {
      palpable::copy_color(*colors, open.camera.images.left);
    } else {
      palpable::draw_depth(open.camera.images.depth, open.camera.images.left);
    }
    process(open, moment);
  });
}

palpable_status palpable_get_depth(const palpable_session* session, palpable_depth* depth) {
  return guarded([&] {
    const palpable_session& open = palpable::opened_with_arrays(session);
    if (!open.camera || open.frames == 0) {
      throw Failure(PALPABLE_NOT_POSSIBLE, "no camera has measured a depth yet");
    }
    const palpable::SeenFrame& seen = seeing(open).scene().seen;
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
