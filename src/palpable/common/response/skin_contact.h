/// @file
/// The contact law of a body with tables: no seen obstacle may enter the skin, anywhere, whatever
/// the number of obstacles (response/touch_solver.h). The solver is given the surface that was seen
/// (pressing_surface.h), and its forces are returned as a list of touches.
///
/// What one camera sees is uncertain by sigma. A contact point is therefore given a compliance of
/// its own in addition to the body's: neighbours whose gaps differ by a sigma then share a force,
/// instead of one of them bearing all of it.
///
///   F  vertices of the skin
#pragma once

#include "palpable/common/contact/contact_pressure.h"
#include "palpable/common/contact/pressing_surface.h"
#include "palpable/common/contact/touch.h"
#include "palpable/common/contact/touch_patches.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/response/touch_solver.h"

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace palpable {

/// Allocates in its constructor, and when a state is used for the first time.
class SkinContact {
 public:
  /// @param skin    at rest
  /// @param fixed   (F) 1 where the support holds the vertex
  /// @param tables  of the skin; outlive this
  SkinContact(const SurfaceMesh& skin, std::span<const std::uint8_t> fixed,
              const TouchTables& tables, const TouchSettings& settings = {});

  /// One frame: a pure function of its arguments.
  /// @param touches  overwritten: one for each contact patch, the one with the largest force first
  /// @param time     s, since the frame before; none: without inertia
  TouchReport advance(TouchState& state, const PressingSurface& seen, std::vector<Touch>& touches,
                      std::optional<double> time = {});

  /// m, the step limit where no motion was seen. An object's unseen side is guessed anew in each
  /// frame and may jump; without the limit the skin would jump with it.
  static constexpr double kMove = 0.00375;
  /// The step limit of a frame, m: kMove, or as far as the obstacles were seen to move if that is
  /// more.
  [[nodiscard]] static double largest_move(const PressingSurface& seen);
  /// The touches of a state that another solver advanced (contact/contact_solver.h).
  /// @param seen    tells which part of it is assumed or remembered; null: all is measured
  /// @param others  where other bodies' contact points press this one
  void find_touches(const TouchState& state, const Obstacles* seen,
                    std::span<const PressedPoint> others, std::vector<Touch>& touches);

  /// The contact pressure on the skin in the frame advanced last (contact_pressure.h).
  /// @param vertices, normals  (3 x F) of its state  @param pressure  (F) Pa, overwritten
  void find_pressure(const Eigen::Matrix3Xf& vertices, const Eigen::Matrix3Xf& normals,
                     std::vector<float>& pressure) {
    pressure_.spread(patches_, vertices, normals, pressure);
  }

  /// The solver: it is queried for the load of a state and given the full-order solution of it.
  [[nodiscard]] TouchSolver& solver() { return solver_; }

  /// The stress on the skin in a state, Pa, as TouchSolver::stress().
  /// @param von_mises  (F)  @param cauchy  (6F), empty: not computed
  void stress(const TouchState& state, std::span<float> von_mises,
              std::span<float> cauchy = {}) const {
    solver_.stress(state, von_mises, cauchy);
  }
  /// The positions of the skin in a state, (3 x F) m, as TouchSolver::place().
  void place(const TouchState& state, Eigen::Matrix3Xf& skin) const { solver_.place(state, skin); }

 private:
  void find_pressed(const TouchState& state);

  TouchSolver solver_;
  std::vector<Eigen::Vector3f> moved_;  // m, displacements of the pressed points
  TouchPatches patches_;
  ContactPressure pressure_;
};

}  // namespace palpable
