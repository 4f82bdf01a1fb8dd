/// @file
/// The vibration modes of a body as a body file stores them: what the live half needs to give a
/// body inertia. It has nothing to do with ModalTables, whose modes are those of a static energy.
///
///   W  nodes of the shell (shell_table.h), the skin's vertices first     m  modes
///
///     K phi_i = omega_i^2 M phi_i,   phi_i^T M phi_j = delta_ij,   u(t) = sum_i phi_i q_i(t),
///     q_i'' + 2 zeta omega_i q_i' + omega_i^2 q_i = phi_i^T f
///
/// Computed on the mesh of the tables at the state without contact (solid/vibration_modes.h).
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <string_view>
#include <vector>

namespace palpable {

/// Largest number of modes in a body file.
inline constexpr int kMostVibrationModes = 256;

struct VibrationTable {
  std::vector<double> omega;  ///< (m) rad/s, > 0, not falling
  /// (m x 3W) 1/sqrt(kg): column 3 n + c is component c of all modes at node n, the order of the
  /// rows of ComplianceTable. Where a force f acts at vertex v, q's forces are
  /// shapes.middleCols(3 v, 3) * f.
  Eigen::MatrixXf shapes;
  double loss_factor = 0;  ///< of the material, 0 <= eta < 1
  double density = 0;      ///< kg/m^3, of the undeformed body
  double mass = 0;         ///< kg, of the body

  [[nodiscard]] int mode_count() const { return static_cast<int>(omega.size()); }
  /// Damping ratio zeta of every mode: a loss factor eta loses 2 pi eta of the largest stored
  /// energy in a cycle, a damped oscillator 4 pi zeta of it at its own frequency.
  [[nodiscard]] double damping() const { return loss_factor / 2; }
};

[[nodiscard]] std::size_t bytes_of(const VibrationTable& table);

/// The part of a table that is invalid for a shell with this number of nodes; empty if none is.
[[nodiscard]] std::string_view trouble_of(const VibrationTable& table, int nodes);

/// The table of a body with every length multiplied by `s`, of the same material: masses grow by
/// s^3 and stiffness by s, so that frequencies are divided by s and shapes of unit mass by s^1.5.
[[nodiscard]] VibrationTable scaled(const VibrationTable& table, double s);

}  // namespace palpable
