/// @file
/// The inertia of a body with tables: its displacement is that of the tables plus what its
/// vibration modes lag behind their static displacement, or ring beyond it.
///
///     u = u_tables(f) + Phi r,     r = q - Omega^-2 p,     p = Phi^T f
///
/// with q the modal coordinates, Phi the shapes and Omega the frequencies (vibration_table.h). A
/// body at rest has r = 0, so that the tables alone answer. In a time step h forces are constant,
/// and q follows exactly, as a damped oscillator (w_d^2 = (1 - zeta^2) omega^2):
///
///     q+  = A q + B q' + alpha p           A  = e^(-zeta omega h) (cos w_d h + zeta omega/w_d sin
///     w_d h) q'+ = -omega^2 B q + B' q' + B p     B  = e^(-zeta omega h) sin(w_d h) / w_d alpha =
///     (1 - A) / omega^2            B' = e^(-zeta omega h) (cos w_d h - zeta omega/w_d sin w_d h)
///
/// Within a step the displacement is therefore linear in the modal forces, and the compliance of
/// the tables changes by D:
///
///     u = u_tables(f) + Phi (r0 + D p),    r0 = A q + B q',    D = alpha - Omega^-2
///
/// A step without time corrects the forces, as where a measurement corrects an obstacle: r and q'
/// stay as they are, D = 0.
///
///   W  nodes of the shell, the skin's vertices first     m  modes that are used
#pragma once

#include "palpable/common/geometry/rigid.h"
#include "palpable/common/response/compliance.h"
#include "palpable/common/response/rounded_rows.h"
#include "palpable/common/response/vibration_table.h"

#include <Eigen/Core>

#include <cstddef>
#include <span>
#include <vector>

namespace palpable {

/// A load as the nonlinear terms follow it (followed_loads.h).
struct FollowedLoad {
  int vertex = 0;
  Eigen::Vector3f force = Eigen::Vector3f::Zero();  ///< N
  float time = 0;                                   ///< s in which it is followed
};

/// What moves when a frame ends. The default is a body at rest.
struct VibrationState {
  std::vector<double> q;         ///< (m) sqrt(kg) m, modal coordinates; empty: 0, as all others
  std::vector<double> velocity;  ///< (m) sqrt(kg) m/s
  std::vector<double> force;     ///< (m) N/sqrt(kg), p of the last step

  bool moves = false;                  ///< r or q' is not 0. A body that is pressed may be at rest
  std::vector<FollowedLoad> followed;  ///< of a body with nonlinear terms
};

/// Allocates in its constructor.
class Inertia {
 public:
  /// rad/s, 125 Hz: modes of higher frequency are taken as static. The step of a haptic device, 1
  /// ms, is an eighth of this period, and a frame of 33 ms gets 33 steps at most.
  static constexpr double kFastest = kTurn * 125;

  /// Whether one of a table's modes is used.
  [[nodiscard]] static bool has_modes(const VibrationTable& table) {
    return !table.omega.empty() && table.omega.front() <= kFastest;
  }
  /// @param table  valid for a shell with `nodes` nodes
  Inertia(const VibrationTable& table, int nodes);

  [[nodiscard]] int mode_count() const { return static_cast<int>(omega_.size()); }  ///< m
  /// Number of equal steps into which a time (s) is divided, >= 1: an eighth of the shortest
  /// period at most.
  [[nodiscard]] int steps_in(double time) const;

  /// Sets the duration of the following steps, s, >= 0. @param h  0: no time passes
  void set_step(double h);
  [[nodiscard]] double step() const { return h_; }
  /// A step begins in a state.
  void begin_step(const VibrationState& state, std::span<const VertexForce> loads);
  /// Computes modal forces and coordinates under loads: p, and r = r0 + D p.
  void load(std::span<const VertexForce> loads);

  /// m, displacement of a vertex by the modes: Phi r.
  [[nodiscard]] Eigen::Vector3f displacement_at(int vertex) const;
  /// (3 x W) m, Phi r at the first `nodes` nodes; what the columns after them hold is not defined.
  /// Valid until field() is called again.
  [[nodiscard]] const Eigen::Matrix3Xf& field(Eigen::Index nodes);
  /// (3 x W) m, Phi r of a state between steps. Valid until field() is called again.
  [[nodiscard]] const Eigen::Matrix3Xf& field(const VibrationState& state);

  // The tangent: W_ij += y_i . D y_j, with y = Phi^T d of a unit force d.

  [[nodiscard]] std::size_t row_width() const { return width_; }  ///< m, padded (row_kernels.h)
  /// row += Phi^T force at a vertex. @param row  (row_width())
  void add_row(int vertex, const Eigen::Vector3f& force, std::span<float> row) const;
  /// result = D row. @param row, result  (row_width())
  void times(std::span<const float> row, std::span<float> result) const;
  /// m/N, y . Omega^-2 y: the part of the modes in a static compliance.
  [[nodiscard]] double static_compliance(std::span<const float> row) const;
  [[nodiscard]] std::span<const float> modal_forces() const { return p_; }  ///< p, padded
  /// m/N, the part of the modes in the static compliance of a vertex, summed over x, y and z.
  [[nodiscard]] double static_compliance_at(int vertex) const;
  /// s, of the lowest mode; 0 without modes.
  [[nodiscard]] double slowest_period() const;

  /// The state is static under the loads: r = q' = 0.
  void rest(VibrationState& state, std::span<const VertexForce> loads);
  /// Time passes for a state under the forces that it has. Sets no step.
  void ring_on(VibrationState& state, double time);
  /// The step ends: the state becomes that under the loads of the last load().
  /// @param may_rest  nothing is near: what moves less than can be seen comes to rest
  void end_step(VibrationState& state, bool may_rest) const;
  /// Reduces the change of a state since it was `began` to a share of it.
  /// @pre both have passed rest() or end_step()
  void limit_step(VibrationState& state, const VibrationState& began, double share) const;

  /// J, of the modes' motion around their static displacement:
  /// sum of (q'^2 + omega^2 r^2) / 2.
  [[nodiscard]] double energy(const VibrationState& state) const;
  /// m/s, no vertex is moved faster by the modes.
  [[nodiscard]] double largest_speed(const VibrationState& state) const;
  /// m, how far the modes have moved that of the vertices which they moved farthest, since their
  /// coordinates were these (VibrationState::q).
  [[nodiscard]] double largest_way(std::span<const double> since, const VibrationState& now,
                                   std::span<const int> vertices);
  /// m, no vertex is farther from its static position, now or as long as forces do not change.
  [[nodiscard]] double amplitude(const VibrationState& state) const;

 private:
  [[nodiscard]] double lag(const VibrationState& state, std::size_t mode) const;
  void fill(std::span<const float> r, Eigen::Index nodes);

  std::vector<double> omega_;    // (m) rad/s
  double damping_ = 0;           // zeta
  std::size_t width_ = 0;        // m, padded
  RowsOfFloats rows_;            // (3W x width) Phi
  std::vector<double> largest_;  // (m) 1/sqrt(kg), largest displacement of a node in Phi

  // The step.
  double h_ = 0;  // s
  struct Propagator {
    double a = 1, b = 0, b_rate = 1;  // A, B, B'
  };
  [[nodiscard]] Propagator over(double time, double omega) const;
  std::vector<Propagator> step_;      // (m)
  std::vector<double> q_, velocity_;  // (m) when the step began
  std::vector<double> began_;         // (m) r0
  std::vector<float> p_, r_, d_;      // (width) modal forces, r, D
  std::vector<float> of_state_;       // (width) r of a state
  Eigen::Matrix3Xf field_;            // (3 x W) m
};

}  // namespace palpable
