/// @file
/// Bodies with tables of touch that press each other, and other bodies that stand in their way.
///
/// Each body has its own solver (contact/touch_solver.h); this class couples them. Of two bodies, A
/// before B in the list, the contact points of A take B's deformed skin as one more obstacle. B's
/// skin yields, so A's complementarity problem becomes
///
///     g + (W_A + W_B) (f_new - f) >= 0,   f_new >= 0, complementary        W_B = N_B G_B N_B^T
///
/// with G_B the compliance of B's tables, to first order. Then B is answered with exactly the
/// opposite forces on it, in full, and its new skin is A's obstacle in the next round:
///
///     A: f  ->  B: u_B(-f)  ->  A: f  ->  ...        3 rounds a frame at most
///
/// There is one force between the two, A's, and what a round leaves is only what W_B does not know
/// of B: its higher orders, and what else presses it. Where that makes B stiffer, as a hand behind
/// it does, a round goes too far by less than W_B / (W_A + W_B), and the next one comes back: it
/// converges whatever the two are made of. Rounds begin with the forces of the frame before.
///
/// A body that can take but one load at a time, or that is answered elsewhere (modal_bodies.h), is
/// an obstacle that does not give way: it presses and is not pressed.
///
///   F  vertices of a skin
#pragma once

#include "palpable/common/contact/obstacles.h"
#include "palpable/common/contact/pressing_surface.h"
#include "palpable/common/contact/skin_contact.h"
#include "palpable/common/contact/touch.h"
#include "palpable/common/contact/touch_solver.h"
#include "palpable/common/contact/touch_state.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/response/touch_tables.h"

#include <Eigen/Core>

#include <memory>
#include <span>
#include <vector>

namespace palpable {

/// How one frame of them went.
struct PressingReport {
  int rounds = 0;        ///< 0: nothing pressed anything
  double between = 0;    ///< m, of bodies into each other, at the points that press
  double imbalance = 0;  ///< N, of the forces between bodies: what one bears and the other does not
};

/// Advancing allocates nothing after the first frame.
class PressingBodies {
 public:
  /// One of the session's bodies, in their order.
  struct Body {
    const SurfaceMesh* skin = nullptr;  ///< closed; at rest
    Rigid3 world_from_body = Rigid3::Identity();
    // Of one with tables; else null, and it is an obstacle alone.
    const TouchTables* tables = nullptr;
    SkinContact* contact = nullptr;
    TouchState* state = nullptr;
    const PressingSurface* seen = nullptr;  ///< of real things that press it; read in each frame
    /// Likewise, where `seen` is null; then there are no touches to find.
    const Obstacles* obstacles = nullptr;
  };
  /// @param bodies  what they point to outlives this
  explicit PressingBodies(const std::vector<Body>& bodies);
  ~PressingBodies();

  /// One frame: the states of all bodies with tables.
  const PressingReport& advance();
  /// Whether a body is one with tables; else it is an obstacle.
  [[nodiscard]] bool is_answered(int body) const;
  /// Where an obstacle is from now on. @param vertices  (3 x F) m
  void move_obstacle(int body, const Eigen::Matrix3Xf& vertices);

  /// Of a body with tables: the strongest first, Touch::by a number of a body.
  void find_touches(int body, std::vector<Touch>& touches);
  [[nodiscard]] bool is_at_rest(int body) const;
  [[nodiscard]] const TouchReport& report_of(int body) const;             ///< of its last answer
  [[nodiscard]] const PressingReport& report() const { return report_; }  ///< of the last frame

 private:
  struct Part;
  struct Pair;
  [[nodiscard]] Part& part(int body) const { return *parts_[static_cast<std::size_t>(body)]; }
  void pair_up();
  class AroundBody;
  void find_near_pairs();
  void gather_given(int body);
  void keep_largest(Part& part);
  double answer(int body, int round);
  void find_between();

  std::vector<std::unique_ptr<Part>> parts_;
  std::vector<Pair> pairs_;
  double move_ = 0;  // m that a vertex may go in this frame
  PressingReport report_;
  std::vector<Eigen::Vector3f> moved_;     // of pressed points
  std::vector<Eigen::Vector3f> places_;    // of points in another body's frame,
  std::vector<SurfaceGap> gaps_;           // and their gaps to it
  std::vector<YieldingPoint> of_one_;      // points before one body,
  std::vector<std::size_t> which_of_one_;  // and which
  std::vector<double> yield_;              // of these
};

}  // namespace palpable
