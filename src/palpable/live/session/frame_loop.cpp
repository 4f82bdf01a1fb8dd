#include "palpable/live/session/frame_loop.h"

#include <utility>

namespace palpable {
namespace {

void see(FrameLoop& loop, const Frame& frame) {
  loop.camera.see(frame, loop.scene.seen);
  loop.scene.times = loop.camera.last_times();
}

}  // namespace

Result<FrameLoop> FrameLoop::make(TouchableBody body, const Rigid3& world_from_body,
                                  const FrameFormat& format, const SessionSettings& settings) {
  std::vector<PlacedBody> bodies;
  bodies.push_back({std::move(body), world_from_body});
  return make(std::move(bodies), format, settings);
}

Result<FrameLoop> FrameLoop::make(std::vector<PlacedBody> bodies, const FrameFormat& format,
                                  const SessionSettings& settings) {
  Result<DepthCamera> camera = DepthCamera::make(format, settings.depth);
  if (!camera.ok()) return camera.problem();
  Result<Session> session = Session::make(std::move(bodies), camera.value(), format, settings);
  if (!session.ok()) return session.problem();
  return FrameLoop{std::move(camera).value(), std::move(session).value()};
}

const Scene& FrameLoop::process(const Frame& frame) {
  see(*this, frame);
  session.respond(scene);
  return scene;
}

const Scene& FrameLoop::process(const Frame& frame,
                                const std::optional<Rigid3>& world_from_camera) {
  see(*this, frame);
  session.respond(scene, world_from_camera);
  return scene;
}

}  // namespace palpable
