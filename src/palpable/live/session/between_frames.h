/// @file
/// Contact at a higher rate than the camera's: between two frames the obstacles are moved on with
/// their measured velocity (seen_object/surface_motion.h), and contact is solved again.
///
///     frame n ── solved ──> its touches, its obstacles and the velocity of each
///                                 │ 1 ms later      │ 2 ms later
///                                 v                 v
///                              touches, shape    touches, shape    ...     until frame n + 1
///
/// Nothing of this goes back into the session: frame n + 1 is solved from the state of frame n. So
/// a run is the same with it and without it, and the results between frames depend on those frames
/// alone.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/contact/pressing_surface.h"
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

/// The result of a session's frame, as far as BetweenFrames needs it. Plain data, for another
/// thread.
struct SolvedFrame {
  int number = 0;
  double time = 0;                ///< s
  std::vector<ObjectBall> balls;  ///< body frame
  /// Of a body with friction, whose session knows the motion of the balls: their velocities, m/s,
  /// and s since the frame before.
  std::optional<double> interval;
  std::vector<Eigen::Vector3f> velocities;
  Eigen::Vector3f camera = Eigen::Vector3f::Zero();  ///< m, body frame: its position
  TouchState state;
  double left_to_move = 0;  ///< m, Scene::left_to_move

  /// Copies the result of the session's last frame; keeps its memory.
  void take(const Session& session, const Scene& scene);
};

/// For a session of one body with tables of touch, without corrections by full-order solutions.
///
/// May run on its own thread: it shares with the session only the body's tables, which do not
/// change. Allocates nothing once its memory suffices.
class BetweenFrames {
 public:
  /// Why contact cannot be solved between the frames of a session; nothing if it can.
  [[nodiscard]] static std::optional<Problem> trouble_of(const Session& session);

  /// @pre trouble_of(session) is empty
  /// @param session  outlives this
  explicit BetweenFrames(const Session& session);

  /// Continues from this frame.
  void begin(const SolvedFrame& frame);
  /// s between that frame and the one before it; 0: it is the first one, or came long after.
  [[nodiscard]] double interval() const { return motion_.interval(); }

  /// Solves contact at `ahead` s after the frame, by a tick (contact/contact_solver.h). Call it
  /// with rising times.
  void advance(double ahead);
  /// The touches of the last advance(), else of the frame: one per contact patch, the strongest
  /// first.
  [[nodiscard]] const std::vector<Touch>& touches() const { return touches_; }
  /// Its displacement may be that of some ticks before, until place() is called.
  [[nodiscard]] const TouchState& state() const { return state_; }
  /// Positions of the skin at that time, (3 x F) m.
  void place(Eigen::Matrix3Xf& skin);
  /// Positions of the skin in another state of the body.
  void place(const TouchState& state, Eigen::Matrix3Xf& skin) const { contact_.place(state, skin); }

 private:
  Eigen::AlignedBox3d region_;
  SkinContact contact_;
  SurfaceMotion motion_;
  ObjectSurface surface_;
  bool dynamics_;  // SessionSettings::dynamics
  Eigen::Vector3f camera_ = Eigen::Vector3f::Zero();
  double ahead_ = 0;       // s after the frame, of the last advance()
  double fastest_ = 0;     // m/s, of the frame's balls
  bool is_solved_ = true;  // nothing was left to move in the frame
  std::vector<ObjectBall> balls_;
  TouchState state_;
  std::vector<Touch> touches_;
};

}  // namespace palpable
