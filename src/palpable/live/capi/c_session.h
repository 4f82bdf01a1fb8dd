/// @file
/// The objects behind the handles of palpable.h.
#pragma once

#include "palpable/common/contact/touch.h"
#include "palpable/common/geometry/capsule.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/common/response/touchable_body.h"
#include "palpable/live/capi/palpable.h"
#include "palpable/live/capi/session_camera.h"
#include "palpable/live/things/pressed_bodies.h"
#include "palpable/live/things/scene_body.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

/// A body file that was read, and a pose. Sessions on the same body share the data.
struct palpable_body {
  std::shared_ptr<const palpable::TouchableBody> body;
  palpable::Rigid3 world_from_body = palpable::Rigid3::Identity();
  std::optional<double> friction = {};  ///< none: that of the body's tables
  bool dynamics = true;                 ///< palpable_set_dynamics()
};

namespace palpable {

/// @throws Failure when is_scale() is false
void require_scale(double scale);

/// @param scale  factor of every length
[[nodiscard]] std::unique_ptr<palpable_body> handle_of(TouchableBody body, double scale);

}  // namespace palpable

/// What palpable_keep_frame() takes out of a session.
struct palpable_kept_frame {
  std::vector<palpable_body> bodies;  // hold the triangles
  std::vector<palpable::SceneBody> shown;
  palpable::DepthImage depth;
};

/// A camera or capsules press the bodies.
struct palpable_session {
  /// @param camera  null for a session without a camera
  /// @throws Failure when the bodies do not suit the session or the camera rejects them
  palpable_session(std::vector<palpable_body> bodies,
                   std::unique_ptr<palpable::SessionCamera> camera);
  palpable_session(const palpable_session&) = delete;
  palpable_session& operator=(const palpable_session&) = delete;

  /// Back to the state before the first frame.
  void reset();

  /// @param things  within the limits of thing_limits.h; their ids differ
  /// @param at      s
  /// @param moves   whether time passes for the bodies since the last frame
  void process_things(std::span<const palpable_thing> things, double at, bool moves);

  /// A tick (palpable_tick_at). @param things, at  as there  @param forces  one for each thing
  /// @return whether the answer was reached
  bool tick_things(std::span<const palpable_thing> things, double at,
                   std::span<palpable::ThingForce> forces);

  /// s, of the last frame or tick; not a number before the first one.
  [[nodiscard]] double last_time() const { return std::fmax(time, ticked_); }
  [[nodiscard]] bool is_first() const { return std::isnan(last_time()); }

  /// Moves the arrays of the last frame out. shown() has none until the next one.
  [[nodiscard]] palpable_kept_frame keep_frame();

  /// Of the last frame, the strongest first.
  [[nodiscard]] const std::vector<palpable::Touch>& touches() const {
    return camera ? camera->touches() : touches_;
  }
  /// One for each body.
  [[nodiscard]] const std::vector<palpable::SceneBody>& shown() const {
    return camera ? camera->shown() : shown_;
  }

  const std::vector<palpable_body> bodies;
  const std::unique_ptr<palpable::SessionCamera> camera;

  int frames = 0;                                          ///< processed so far
  double time = std::numeric_limits<double>::quiet_NaN();  ///< s, caller's clock
  double left_to_go = 0;                                   ///< m, palpable_frame::left_to_go
  double inside = 0;                                       ///< m, palpable_frame::inside
  palpable_answer answer = PALPABLE_NOT_JUDGED;
  int passed_through = 0;            ///< palpable_frame::passed_through
  double ringing = 0;                ///< J, palpable_frame::ringing
  std::vector<std::int64_t> things;  ///< ids of the last frame's, to which Touch::thing is an index
  bool arrays_are_kept = false;      ///< by keep_frame(), since the last frame
  bool is_broken = false;            ///< a call was interrupted by an exception

 private:
  void take_things(std::span<const palpable_thing> the_things);

  std::unique_ptr<palpable::PressedBodies> press_;
  double ticked_ = std::numeric_limits<double>::quiet_NaN();  // s, of the last tick
  std::vector<palpable::Capsule> capsules_;
  std::vector<palpable::CapsuleThing> things_;
  std::vector<palpable::Touch> touches_;
  std::vector<palpable::SceneBody> shown_;
};

namespace palpable {

/// Shows bodies at rest: shape and normals, without stress.
/// @param shown  overwritten, one for each body
void show_rest(std::span<const palpable_body> bodies, std::vector<SceneBody>& shown);

}  // namespace palpable
