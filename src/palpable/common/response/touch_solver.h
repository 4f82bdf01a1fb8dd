/// @file
/// One frame of touch of one body with tables: unilateral, frictionless contact of its skin with
/// whatever is near it.
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
///   V  vertices that the tables know, of the skin or of a coarser one that carries it
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
  int patches = 0;        ///< patches of load that regions answered for
  double last_share = 0;  ///< of the series' last order, see NonlinearResponse
  ErrorSigns signs;       ///< of the state's own error; 0 without force
  /// What they say; nothing without force, of a state that is held back, or where the tables'
  /// held-out touches give no scale.
  std::optional<StatedError> stated;
};
/// That of a body which was solved with others. @param solver  in which it is number `member`
[[nodiscard]] TouchReport report_of(const TablesBody& body, const ContactSolver& solver,
                                    int member);

/// A body that is touched. Advancing allocates nothing once a state has had its room.
class TouchSolver {
 public:
  static constexpr int kMostPoints = palpable::kMostPlaces;  ///< that may press at a time

  /// @param skin    (F vertices) the body's, at rest
  /// @param fixed   (F) 1 where the support holds the vertex
  /// @param tables  of the skin; outlive this
  TouchSolver(const SurfaceMesh& skin, std::span<const std::uint8_t> fixed,
              const TouchTables& tables, const TouchSettings& settings = {});

  /// (C) on the V vertices.
  [[nodiscard]] std::span<const SkinPoint> points() const { return body_->points(); }
  /// (3 x C) m, of the points at rest.
  [[nodiscard]] const Eigen::Matrix3Xf& places() const { return body_->points_at_rest(); }

  /// The state in which nothing enters the body. Pure: the same state and gaps give the same bytes.
  /// @param largest_move  m: no vertex goes on by more, whatever came near; what is left to go is
  ///                      gone in the frames after
  TouchReport advance(TouchState& state, const Obstacles& obstacles,
                      double largest_move = std::numeric_limits<double>::infinity());

  /// The load that a state bears, to be answered exactly. False: there is none, or an answer is
  /// still being blended in. Allocates nothing once `asked` has had its room.
  /// @pre the state was not held back
  [[nodiscard]] bool request(const TouchState& state, RequestedLoad& asked) {
    return body_->request(state, asked);
  }
  /// Takes up the exact answer to a load, over the frames to come. False: it is so far from the
  /// tables' that the load was more than the body bears; nothing is changed.
  /// @param exact  (3 x W) m
  bool refine(TouchState& state, const RequestedLoad& asked, const Eigen::Matrix3Xf& exact) const {
    return body_->refine(state, asked, exact);
  }

  /// A load all over the skin, so small that its answer is the linear one; what the exact answer is
  /// to agree with, if it is this body's.
  void probe(RequestedLoad& asked) { body_->probe(asked); }
  [[nodiscard]] static bool agrees(const RequestedLoad& probe, const Eigen::Matrix3Xf& exact) {
    return is_of_probed_body(probe, exact);
  }

  /// The stress on the skin in a state, as ShellStress::evaluate(). Allocates nothing; not while
  /// another thread asks or advances.
  /// @param von_mises  (F) Pa  @param cauchy  (6F) Pa, empty: not wanted
  /// @pre the tables have a shell
  void stress(const TouchState& state, std::span<float> von_mises,
              std::span<float> cauchy = {}) const {
    body_->stress(state, von_mises, cauchy);
  }

  /// Where the body's skin is in a state, (3 x F) m. As stress() about threads and allocations.
  void place(const TouchState& state, Eigen::Matrix3Xf& skin) const { body_->place(state, skin); }
  /// How far the points of a state's forces have moved in it, m, force by force. Likewise.
  void find_moved(const TouchState& state, std::vector<Eigen::Vector3f>& moved) const {
    body_->find_moved(state, moved);
  }

  /// What is solved, for a solver of several bodies.
  [[nodiscard]] TablesBody& body() { return *body_; }

 private:
  std::unique_ptr<TablesBody> body_;
  ContactSolver solver_;
};

}  // namespace palpable
