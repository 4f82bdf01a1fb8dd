#include "palpable/live/capi/loop_camera.h"

#include "palpable/common/base/error.h"
#include "palpable/live/capi/c_session.h"
#include "palpable/live/capi/guarded.h"
#include "palpable/live/capi/poses.h"
#include "palpable/live/track/track_states.h"

#include <fmt/core.h>

#include <cstddef>
#include <utility>

namespace palpable {
namespace {

int state_of(TrackState state) {
  switch (state) {
    case TrackState::kStarting:
      return PALPABLE_STARTING;
    case TrackState::kTracking:
      return PALPABLE_TRACKED;
    case TrackState::kLost:
      return PALPABLE_LOST;
    case TrackState::kFixed:
      break;
  }
  return PALPABLE_STANDS;
}

}  // namespace

void LoopCamera::restart(std::span<const palpable_body> bodies) {
  loop_.reset();
  images = {};
  std::vector<PlacedBody> placed;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    TouchableBody body = *bodies[k].body;
    if (bodies[k].friction) set_friction(body, *bodies[k].friction);
    placed.push_back({std::move(body), bodies[k].world_from_body, fmt::format("{}", k)});
  }
  auto loop = FrameLoop::make(std::move(placed), setup.format, setup.session);
  if (!loop.ok()) throw Failure(PALPABLE_WRONG_ARGUMENT, loop.problem().message);
  loop_.emplace(std::move(loop).value());
  loop_->session.keep({.contact_pressure = true});
  show_rest(bodies, loop_->scene.bodies);
  first_time = 0;
  gives_poses = has_frame_ = wrong_pair_ = false;
}

DepthImage LoopCamera::take_depth() {
  DepthImage taken = std::move(loop_->scene.seen.depth);
  loop_->scene.seen.depth.resize(0, 0);
  return taken;
}

void LoopCamera::describe(palpable_frame& frame) const {
  if (has_frame_) frame.camera = state_of(scene().camera.state);
  frame.wrong_pair = wrong_pair_ ? 1 : 0;
  write_pose(scene().camera.world_from_camera, frame.world_from_camera);
}

void LoopCamera::process_images(const std::optional<Rigid3>* pose) {
  if (pose != nullptr) {
    loop_->process(images, *pose);
  } else {
    loop_->process(images);
  }
  wrong_pair_ |= scene().seen.misfit.has_value();
  has_frame_ = true;
}

std::unique_ptr<SessionCamera> camera_of(const palpable_setup& setup) {
  return std::make_unique<LoopCamera>(camera_setup(setup));
}

}  // namespace palpable
