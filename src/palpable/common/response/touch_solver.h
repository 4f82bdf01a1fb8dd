/// @file
/// One frame of contact of one body with tables: unilateral, frictionless contact of its skin with
/// the obstacles near it.
///
///     g_i >= 0,   f_i >= 0,   g_i f_i = 0        at every contact point i,        u = u(f)
///
/// The conditions and how they are solved are in contact/contact_solver.h, u(f) is in
/// tables_body.h.
///
///     Obstacles ── gaps ──► ContactSolver (common/contact)
///                                 │ forces ▼   ▲ positions, compliance
///               ┌─────────────────┴────────────────┐
///          TablesBody  u(f) by tables         ModalBody  energy in modes, W(q)
///           ├─ Compliance       G              ├─ ModalTables  W, and the skin's modes
///           ├─ NonlinearResponse  regions        └─ ModalStress  stress
///           ├─ Refinement       corrections
///           └─ ShellStress      stress
///
/// TouchSolver is ContactSolver with one TablesBody, for programs without a session.
///
///   V  vertices of the tables, of the skin or of a coarser one that carries it
///   F  vertices of the body's skin, V where it is not carried
///   W  nodes of the shell     C  contact points
#pragma once

#include "palpable/common/contact/contact_solver.h"
#include "palpable/common/contact/obstacles.h"
#include "palpable/common/geometry/skin_points.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/response/refinement.h"
#include "palpable/common/response/stated_error.h"
#include "palpable/common/response/tables_body.h"
#include "palpable/common/response/touch_state.h"
#include "palpable/common/response/touch_tables.h"

#include <Eigen/Core>

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace palpable {

/// How one frame went.
struct TouchReport : ContactReport {
  int patches = 0;             ///< patches of load
  double last_share = 0;       ///< NonlinearResponse::last_share()
  ErrorIndicators indicators;  ///< 0 without force
  /// The error by these indicators; nothing without force, for a state at the step limit, where an
  /// obstacle was missed, or where the tables' held-out touches give no factor.
  std::optional<StatedError> stated;
};
/// The report of a body that was solved with others. @param member  its number in `solver`
[[nodiscard]] TouchReport report_of(const TablesBody& body, const ContactSolver& solver,
                                    int member);

/// A body that is touched. Advancing allocates nothing once a state has had its room.
class TouchSolver {
 public:
  static constexpr int kMostPoints = palpable::kMostPlaces;  ///< contact points in one step

  /// @param skin    (F vertices) the body's, at rest
  /// @param fixed   (F) 1 where the support holds the vertex
  /// @param tables  of the skin; outlive this
  TouchSolver(const SurfaceMesh& skin, std::span<const std::uint8_t> fixed,
              const TouchTables& tables, const TouchSettings& settings = {});

  /// (C) the contact points, on the V vertices.
  [[nodiscard]] std::span<const SkinPoint> points() const { return body_->points(); }
  /// (3 x C) m, positions of the contact points at rest.
  [[nodiscard]] const Eigen::Matrix3Xf& places() const { return body_->points_at_rest(); }

  /// Advances the state to the one in which no obstacle enters the body. Pure: the same state and
  /// gaps give the same bytes.
  /// @param largest_move  m, step limit: no vertex moves farther in this frame; the rest of the
  ///                      displacement follows in later frames
  /// @param time          s, since the frame before, for tables with vibration modes; none: the
  ///                      static state, without motion
  TouchReport advance(TouchState& state, const Obstacles& obstacles,
                      double largest_move = std::numeric_limits<double>::infinity(),
                      std::optional<double> time = {});

  /// A tick: one time step for a force device, of which contacts and forces are computed alone
  /// (ContactSolver::tick()). The first one begins from a state after a frame.
  /// @param h    s, since the tick or the frame before, above 0
  /// @param way  m, no obstacle has come farther since then; infinite: not known
  ContactReport tick(TouchState& state, const Obstacles& obstacles, double h, double way);
  /// The displacement of the state of the last tick becomes that under its forces; advance() begins
  /// with it.
  void end_ticks() { solver_.end_ticks(); }
  /// The state was replaced by another one since the last tick.
  void drop_ticks() { solver_.drop_ticks(); }
  /// As ContactSolver::contacts() and ContactSolver::position_of().
  [[nodiscard]] std::span<const Contact> contacts() const { return solver_.contacts(); }
  [[nodiscard]] Eigen::Vector3f position_of(const Contact& contact) const {
    return solver_.position_of(contact);
  }

  /// The load that a state bears, as a request for its full-order solution. False: there is no
  /// load, or a solution is still being blended in. Allocates nothing once `load` has had its room.
  /// @pre the state has nothing left to move (TouchReport::left_to_move)
  [[nodiscard]] bool request(const TouchState& state, RequestedLoad& load) {
    return body_->request(state, load);
  }
  /// Blends the full-order solution of a load in, over the next frames. False: it differs from the
  /// tables' by more than 30 %, which happens where the body does not bear the load without the
  /// obstacle; nothing is changed.
  /// @param exact  (3 x W) m
  bool refine(TouchState& state, const RequestedLoad& load, const Eigen::Matrix3Xf& exact) const {
    return body_->refine(state, load, exact);
  }

  /// A load all over the skin that is so small that its response is linear; agrees() tells by its
  /// full-order solution whether that was computed for this body.
  void probe(RequestedLoad& load) { body_->probe(load); }
  [[nodiscard]] static bool agrees(const RequestedLoad& probe, const Eigen::Matrix3Xf& exact) {
    return is_of_probed_body(probe, exact);
  }

  /// The stress on the skin in a state, as ShellStress::evaluate(). Allocates nothing. Must not run
  /// while another thread calls any function of this object.
  /// @param von_mises  (F) Pa  @param cauchy  (6F) Pa, empty: not computed
  /// @pre the tables have a shell
  void stress(const TouchState& state, std::span<float> von_mises,
              std::span<float> cauchy = {}) const {
    body_->stress(state, von_mises, cauchy);
  }

  /// Positions of the body's skin in a state, (3 x F) m. Threads and allocations as for stress().
  void place(const TouchState& state, Eigen::Matrix3Xf& skin) const { body_->place(state, skin); }
  /// Displacements of the points at which a state's forces act, m, force by force. Likewise.
  /// Also between ticks, whose state's displacement is an older one.
  void find_moved(const TouchState& state, std::vector<Eigen::Vector3f>& moved) const;

  /// The body that is solved, for a solver of several bodies.
  [[nodiscard]] TablesBody& body() { return *body_; }

 private:
  void use(TouchState& state);

  std::unique_ptr<TablesBody> body_;
  ContactSolver solver_;
  const TouchState* used_ = nullptr;  // of the last call
};

}  // namespace palpable
