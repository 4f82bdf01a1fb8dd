/// @file
/// The true stress on the skin of a body that moves in modes. The law is evaluated once per vertex,
/// at the deformation gradient that the full solver's recovery gives there.
///
///     F_v = 1 + sum_i q_i G_iv                G_iv = sum_k weights_k grad F_i at point k
///     sigma_v = (P(F_v) + F_v S_v) F_v^T / J_v
///     S_v = sum_ab y_a y_b S_abv              y = amplitudes of load states in q
///
/// ShellStress evaluates the law at each of the shell's points and then recovers the stress. A
/// recovery reproduces constants, so the two agree up to the square of the gradient's variation
/// around a vertex. S_v is that square, for the few states in which loads do most of their work. An
/// evaluation reads 18 bytes per vertex and mode and 12 bytes per vertex and product of states, a
/// third of what ShellStress reads.
///
///   V  vertices of the skin     W  nodes of its shell (shell_table.h)
///   n  modes                    m  load states
#pragma once

#include "palpable/common/material/simd.h"
#include "palpable/common/response/shell_table.h"

#include <Eigen/Core>

#include <memory>
#include <span>

namespace palpable {

/// Some states into which loads bring a body, and the amplitudes of these states in any other
/// state.
struct LoadStates {
  Eigen::MatrixXf states;  ///< (n x m) amplitudes
  Eigen::MatrixXf duals;   ///< (m x n) y = duals q; duals * states = 1
};

class ModalStress {
 public:
  /// Whether this class can evaluate a table: it has one material, no preload, and a recovery whose
  /// weights sum to 1.
  [[nodiscard]] static bool serves(const ShellTable& table);

  /// Gradients are rounded to 16 bits: the error is at most 1.5e-5 of the mode's largest gradient
  /// among the eight vertices that are stored together.
  /// @param table        @pre trouble_of(table, V) is empty, and serves(table)
  /// @param modes        (3V x n) m, of the skin
  /// @param inner_modes  (3 (W - V) x n) m, of the shell's other nodes
  /// @param loads        m may be 0
  ModalStress(const ShellTable& table, const Eigen::MatrixXf& modes,
              const Eigen::MatrixXf& inner_modes, const LoadStates& loads,
              SimdLevel level = best_simd_level());
  ~ModalStress();
  ModalStress(ModalStress&&) noexcept;

  /// Allocates nothing; the same amplitudes give the same bytes on every processor. Volumes and
  /// stresses are bounded as in ShellStress, so that no result is NaN.
  /// @param q          (n)
  /// @param von_mises  (V) Pa
  /// @param cauchy     (6V) Pa, xx yy zz xy yz zx of each vertex; empty: not computed
  void evaluate(std::span<const float> q, std::span<float> von_mises, std::span<float> cauchy = {});

 private:
  void add_squares(const ShellTable& table, const Eigen::MatrixXf& modes,
                   const Eigen::MatrixXf& inner_modes, const LoadStates& loads);
  [[nodiscard]] float largest_gradient(const Eigen::VectorXf& q) const;

  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace palpable
