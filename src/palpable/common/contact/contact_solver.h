/// @file
/// One frame of contact: unilateral, of deformable bodies with obstacles and with each other,
/// without friction or with Coulomb's.
///
///     g_i >= 0,   f_i >= 0,   g_i f_i = 0          at every contact i, with
///
///     g_i   gap: signed distance of a contact point from the obstacle or skin near it, m
///     f_i   normal force, N: on the body at the point, and the opposite one on the other body
///
/// Friction: |t_i| <= mu f_i, and where it is less the point does not slip (point_anchor.h has the
/// law, coulomb_cone.h the solution). The state of a body then also has an anchor for each point
/// that presses: which place of the obstacle or of the other skin it sticks to.
///
/// How a force comes about:
///
///       ┌────────────┐  which contact points are near an obstacle or near another skin
///    ┌─►│ 1 search   │  contact_search.h, near_points.h, moving_surface.h
///    │  └─────┬──────┘
///    │  ┌─────▼──────┐  obstacles that are deeper than one step are moved back by a shift, and
///    │  │ 2 step     │◄──┐ advance step by step; with friction on their own ways: contact_frame.h
///    │  └─────┬──────┘   │
///    │  ┌─────▼──────┐   │  gaps g at the present positions: to obstacles in one query
///    │  │ 3 gaps     │◄┐ │  (obstacles.h), to skins by tangent planes (contact_search.h)
///    │  └─────┬──────┘ │ │
///    │  ┌─────▼──────┐ │ │  forces f: W f + q >= 0, f >= 0, complementary: contact_problem.h
///    │  │ 4 problem  │ │ │  (with friction: coulomb_cone.h), complementarity.h
///    │  └─────┬──────┘ │ │
///    │  ┌─────▼──────┐ │ │  the bodies move under f: contact_body.h; back to 3 until no point
///    │  │ 5 bodies   ├─┴─┘  moves, then to 2 for the next step
///    │  └─────┬──────┘
///    │  ┌─────▼──────┐  after the last step the whole skin is formed; back to 1, at most
///    └──┤ 6 shape    │  twice, if other points have entered something
///       └────────────┘
///
/// One contact, with an obstacle and between bodies a and b:
///
///        obstacle                            b ─────────────x_b──────────  foot, presses with f
///       ───────────┬──                                       ▲
///                g │  n, out of the obstacle             g   │  n, out of b
///       ───────────▼──                                       ▼
///     a ─────────x_a───  point, pressed by f n      a ──────x_a──────────  point, pressed by f n
///
/// Bodies whose skins are near each other are solved together. A contact between two of them has
/// the compliance of both; the forces on the two are equal and opposite.
#pragma once

#include "palpable/common/contact/contact_body.h"
#include "palpable/common/contact/contact_frame.h"
#include "palpable/common/contact/obstacles.h"
#include "palpable/common/contact/touch_patches.h"
#include "palpable/common/geometry/rigid.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace palpable {

/// advance() allocates nothing once states have had their room.
class ContactSolver {
 public:
  struct Member {
    ContactBody* body = nullptr;  ///< with a state, when advance() is called; outlives the solver
    Rigid3 world_from_body = Rigid3::Identity();
  };
  /// The obstacles near a member in a frame, and its step limit.
  struct Near {
    const Obstacles* obstacles = nullptr;  ///< without other members, body frame; null: none
    /// m, step limit: no vertex moves farther in this frame; the rest of the displacement follows
    /// in later frames. Bodies that are solved together use the largest one.
    double largest_move = std::numeric_limits<double>::infinity();
  };
  explicit ContactSolver(const std::vector<Member>& members);
  ~ContactSolver();
  ContactSolver(ContactSolver&&) noexcept;

  /// Advances the states to those in which nothing enters a body. Pure: the same states and gaps
  /// give the same bytes.
  /// @param near  of each member
  /// @param time  s, since the frame before: bodies with inertia move. After more than an eighth of
  ///              a second obstacles are where they are, as without time, and what rang has rung
  ///              on. None: the static state, without motion
  ContactReport advance(std::span<const Near> near, std::optional<double> time = {});

  // Ticks, for force devices: time steps of about a millisecond of one body alone, each in a
  // fraction of a frame's time. Between ticks its state has its forces, anchors and vibration; its
  // displacement is that of some ticks before (ContactFrame::kLongestShape) until end_ticks().

  /// One tick. It is a whole frame where the call before did not reach its solution, where the way
  /// is longer than a step of contact or not known, and where the time is longer than two steps of
  /// inertia.
  /// @pre the solver has one member, a body with tables
  /// @param near  whose step limit holds in frames alone
  /// @param h     s, since the tick or the frame before, above 0
  /// @param way   m, no obstacle has come farther since then; infinite: not known
  ContactReport tick(const Near& near, double h, double way);
  /// The state becomes that under its forces, in all parts. advance() begins with it.
  void end_ticks();
  /// Whether the last call was a tick.
  [[nodiscard]] bool ticks() const;
  /// The member's state was replaced by another one since the last tick.
  void drop_ticks();
  /// The contacts of the last tick or frame, before its step limit; those with Contact::pressing
  /// above 0 press.
  [[nodiscard]] std::span<const Contact> contacts() const;
  /// m, position of a contact's point in the frame of its body. @pre one of contacts()
  [[nodiscard]] Eigen::Vector3f position_of(const Contact& contact) const;

  // These are for one member, after the frame advanced last.

  /// The report of the member and those that were solved with it.
  [[nodiscard]] const ContactReport& report_of(int member) const;
  /// m, penetration of obstacles at its deepest contact point.
  [[nodiscard]] double penetration_of(int member) const;
  /// The points at which contact points of other members press it.
  [[nodiscard]] std::span<const PressedPoint> pressed_by_others(int member) const;
  /// Whether nothing presses it and its shape is that at rest.
  [[nodiscard]] bool is_at_rest(int member) const;

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace palpable
