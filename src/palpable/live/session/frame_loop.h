/// @file
/// Turns a camera's frame into a scene: both halves of a live run on one thread.
///
///     frame -- DepthCamera::see() --> colour + depth -- Session::respond() --> touches, u, sigma
///
/// The two halves share nothing but the scene that one passes to the other. So the next frame can
/// be converted to depth on one thread while this one is solved on another, as live/player does
/// with the same two objects.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/frame.h"
#include "palpable/live/depth/depth_camera.h"
#include "palpable/live/session/scene.h"
#include "palpable/live/session/session.h"

#include <optional>
#include <vector>

namespace palpable {

struct FrameLoop {
  DepthCamera camera;  ///< frames to depth
  Session session;     ///< depth to touches and shapes
  Scene scene{};       ///< of the frame processed last

  /// A problem when the format's numbers do not define a depth camera, or a setting is out of
  /// range.
  /// @param bodies  as Session::make()
  [[nodiscard]] static Result<FrameLoop> make(std::vector<PlacedBody> bodies,
                                              const FrameFormat& format,
                                              const SessionSettings& settings = {});
  /// The same with one body.
  /// @param world_from_body  the body's pose; the world is the first frame's camera
  [[nodiscard]] static Result<FrameLoop> make(TouchableBody body, const Rigid3& world_from_body,
                                              const FrameFormat& format,
                                              const SessionSettings& settings = {});

  /// Processes one frame. The scene is overwritten by the next call.
  const Scene& process(const Frame& frame);
  /// The same with a pose that is known from elsewhere (Session::respond).
  const Scene& process(const Frame& frame, const std::optional<Rigid3>& world_from_camera);
};

}  // namespace palpable
