/// @file
/// The law of a body with tables: nothing that is seen may enter the skin, anywhere, however many
/// things there are (response/touch_solver.h). The solver is given the surface that was seen
/// (pressing_surface.h), and its forces are returned as a list of touches.
///
/// What one camera sees is uncertain by sigma. A point's gap is therefore given a compliance of its
/// own beside the body's: neighbours that are off by a sigma share a force instead of fighting for
/// it.
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
#include <span>
#include <vector>

namespace palpable {

/// Makes its tables once, then allocates nothing once a state has had its room.
class SkinContact {
 public:
  /// @param skin    at rest
  /// @param fixed   (F) 1 where the support holds the vertex
  /// @param tables  of the skin; outlive this
  SkinContact(const SurfaceMesh& skin, std::span<const std::uint8_t> fixed,
              const TouchTables& tables, const TouchSettings& settings = {});

  /// One frame: a pure function of its arguments.
  /// @param touches  overwritten: a patch of skin each, the one with the largest force first
  TouchReport advance(TouchState& state, const PressingSurface& seen, std::vector<Touch>& touches);

  /// m that a vertex may go from one frame to the next, where nothing was seen to move: an object's
  /// unseen side is guessed anew in each frame, and jumps.
  static constexpr double kMove = 0.00375;
  /// That, or as far as what presses was seen to move.
  [[nodiscard]] static double largest_move(const PressingSurface& seen);
  /// The touches of a state that another one than advance() brought about
  /// (contact/contact_solver.h).
  /// @param seen    says which of it is assumed, or held; null: all is measured
  /// @param others  where other bodies' contact points press this one
  void find_touches(const TouchState& state, const Obstacles* seen,
                    std::span<const PressedPoint> others, std::vector<Touch>& touches);

  /// How hard things press the skin in the frame answered last (contact_pressure.h).
  /// @param vertices, normals  (3 x F) of its state  @param pressure  (F) Pa, overwritten
  void find_pressure(const Eigen::Matrix3Xf& vertices, const Eigen::Matrix3Xf& normals,
                     std::vector<float>& pressure) {
    pressure_.spread(patches_, vertices, normals, pressure);
  }

  /// Which answers; to be asked for the load of a state and told its exact answer.
  [[nodiscard]] TouchSolver& solver() { return solver_; }

  /// The stress on the skin in a state, Pa, as TouchSolver::stress().
  /// @param von_mises  (F)  @param cauchy  (6F), empty: not wanted
  void stress(const TouchState& state, std::span<float> von_mises,
              std::span<float> cauchy = {}) const {
    solver_.stress(state, von_mises, cauchy);
  }
  /// Where the skin is in a state, (3 x F) m, as TouchSolver::place().
  void place(const TouchState& state, Eigen::Matrix3Xf& skin) const { solver_.place(state, skin); }

 private:
  void find_pressed(const TouchState& state);

  TouchSolver solver_;
  std::vector<Eigen::Vector3f> moved_;  // of the pressed points
  TouchPatches patches_;
  ContactPressure pressure_;
};

}  // namespace palpable
