/// @file
/// One frame of touch for bodies whose energy is known in some modes: beams that bend far. Several
/// of them are answered together, so that they press each other.
///
///     minimise  sum over bodies W_b(q_b)   so that   g_p(q) >= 0 at every contact point p
///
///     W_b'(q_b) = sum_p f_p B_pb,     g_p >= 0,   f_p >= 0,   g_p f_p = 0,     B_pb = dg_p / dq_b
///
/// Newton's method; each step is the linear complementarity problem (complementarity.h)
///
///     W = sum_b B_b H_b^-1 B_b^T + c        H_b = W_b'' - sum_p f_p d2g_p / dq_b2
///
/// with c the compliance of the skin under a point, that of a half space, which the modes do not
/// know. A point of one body against another body's skin has a B in both: what presses the one
/// presses the other as hard, and neither waits for the other's answer.
///
///   V  vertices of a skin     W  nodes of its shell     n  modes     C  contact points
#pragma once

#include "palpable/common/contact/modal_body.h"
#include "palpable/common/contact/obstacles.h"
#include "palpable/common/contact/touch_solver.h"
#include "palpable/common/geometry/skin_points.h"

#include <Eigen/Core>

#include <memory>
#include <span>
#include <vector>

namespace palpable {

struct ModalSettings {
  double band = 0.004;          ///< m: points nearer than this may press
  double largest_step = 0.004;  ///< m an object goes on in one step
  int most_steps = 8;           ///< of a frame; what is deeper is reached in later frames
  int iterations = 2;           ///< of Newton's method, of each step
  int last_iterations = 10;     ///< of the last one, at most
  double tolerance = 2e-5;      ///< m: the last iteration moved no vertex by more
  double entry = 4e-5;          ///< m a round object may enter between two contact points
  double largest_move = 0.03;   ///< m that an iteration moves a vertex, at most
};

/// A force on a skin.
struct SkinForce {
  SkinPoint at;
  Eigen::Vector3f force = Eigen::Vector3f::Zero();  ///< N, on the body, its frame
  int by = -1;     ///< which other member presses; -1: what is seen
  int point = -1;  ///< the member's contact point; -1: it is the other one's, at a triangle of this
};

/// All that is remembered of a member from frame to frame. The default is the body at rest.
struct ModalState {
  Eigen::VectorXd q;              ///< (n) amplitudes; none: at rest
  std::vector<SkinForce> forces;  ///< of what is seen first, then of other members
};

/// How one frame went.
struct ModalReport {
  int candidates = 0;      ///< points near something
  int dropped = 0;         ///< more of them than there is room for
  int iterations = 0;      ///< of Newton's method in all
  double last_change = 0;  ///< m, of a vertex in the last iteration
  double penetration = 0;  ///< m, of what is seen at the deepest contact point
  double between = 0;      ///< m, of members into each other
  double imbalance = 0;    ///< N, of the forces between members: what does not cancel out
};

/// Advancing allocates nothing once states have had their room.
class ModalContact {
 public:
  static constexpr std::size_t kMostPoints = 160;  ///< that may press at a time, of all members

  /// @param members  what they point to outlives this. @pre trouble_of(tables, body) is empty
  explicit ModalContact(const std::vector<ModalMember>& members,
                        const ModalSettings& settings = {});
  ~ModalContact();
  ModalContact(ModalContact&&) noexcept;

  /// The states in which nothing enters a body. Pure: the same states and gaps give the same bytes.
  /// @param states  one of each member
  /// @param seen    what presses each member, other members apart, in its frame; null: nothing
  ModalReport advance(std::span<ModalState> states, std::span<const Obstacles* const> seen);

  /// (3 x V) m: where a member's skin is. Holds until another member function is called.
  [[nodiscard]] const Eigen::Matrix3Xf& place(int member, const ModalState& state);
  /// Its normals. @param normals  (3 x V) unit
  void normals(int member, const ModalState& state, Eigen::Matrix3Xf& normals);
  /// The true stress on it, Pa. @param von_mises  (V)  @param cauchy  (6V); empty: not wanted
  void stress(int member, const ModalState& state, std::span<float> von_mises,
              std::span<float> cauchy = {});

  [[nodiscard]] int member_count() const;

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace palpable
