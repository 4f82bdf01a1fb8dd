/// @file
/// Contact at a higher rate than the camera's: between two frames the pressing things are moved on
/// with the velocity that was measured (seen_object/surface_motion.h), and contact is solved again.
///
///     frame n ── answered ──> its touches, its things and how fast each moves
///                                 │ 1 ms later      │ 2 ms later
///                                 v                 v
///                              touches, shape    touches, shape    ...     until frame n + 1
///
/// Nothing of it goes back into the session: frame n + 1 is answered from frame n. So a run is the
/// same with it and without, and what is told between frames depends on those frames alone.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/contact/object_ball.h"
#include "palpable/common/contact/touch.h"
#include "palpable/common/response/skin_contact.h"
#include "palpable/common/response/touch_state.h"
#include "palpable/live/seen_object/object_surface.h"
#include "palpable/live/seen_object/surface_motion.h"
#include "palpable/live/session/scene.h"
#include "palpable/live/session/session.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <optional>
#include <vector>

namespace palpable {

/// What is known when a frame has been answered. Plain data, for another thread.
struct SolvedFrame {
  int number = 0;
  double time = 0;                                   ///< s
  std::vector<ObjectBall> balls;                     ///< body frame
  Eigen::Vector3f camera = Eigen::Vector3f::Zero();  ///< m, body frame: where it sees from
  TouchState state;

  /// Takes over what the session answered last; its memory is used again.
  void take(const Session& session, const Scene& scene);
};

/// For a session of one body that its tables answer, without exact answers beside them.
///
/// On a thread of its own: it shares the body's tables with the session, which do not change.
/// Allocates nothing once its memory suffices.
class BetweenFrames {
 public:
  /// Why a session's body is not answered between frames; nothing if it is.
  [[nodiscard]] static std::optional<Problem> trouble_of(const Session& session);

  /// @pre trouble_of() has none
  /// @param session  outlives this
  explicit BetweenFrames(const Session& session);

  /// Goes on from here.
  void begin(const SolvedFrame& frame);
  /// s between that frame and the one before it; 0: it is the first, or was long after.
  [[nodiscard]] double interval() const { return motion_.interval(); }

  /// Answers `ahead` s after the frame. Call it with rising times.
  void advance(double ahead);
  /// As advance() found them, or as the frame had them: a patch of skin each, the strongest first.
  [[nodiscard]] const std::vector<Touch>& touches() const { return touches_; }
  [[nodiscard]] const TouchState& state() const { return state_; }
  /// Where the skin is then, (3 x F) m.
  void place(Eigen::Matrix3Xf& skin) const { contact_.place(state_, skin); }
  /// Where it is in another state of the body.
  void place(const TouchState& state, Eigen::Matrix3Xf& skin) const { contact_.place(state, skin); }

 private:
  Eigen::AlignedBox3d region_;
  SkinContact contact_;
  SurfaceMotion motion_;
  ObjectSurface surface_;
  Eigen::Vector3f camera_ = Eigen::Vector3f::Zero();
  double ahead_ = 0;  // of the answer last made
  std::vector<ObjectBall> balls_;
  TouchState state_;
  std::vector<Touch> touches_;
};

}  // namespace palpable
