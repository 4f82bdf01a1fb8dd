/// @file
/// The true stress on the skin of a body that moves in modes: the law at each vertex, in the
/// gradient that the full solver's recovery gives there.
///
///     F_v = 1 + sum_i q_i G_iv                G_iv = sum_k weights_k grad F_i at point k
///     sigma_v = (P(F_v) + F_v S_v) F_v^T / J_v
///     S_v = sum_ab y_a y_b S_abv              y = states that loads make, in q
///
/// ShellStress has the law at each of the shell's points, and recovers the stress. A recovery
/// leaves a constant as it is, so that both are the same but for the square of what the gradient
/// varies by around a vertex; S_v is that square in the few states that most of what loads do is
/// made of. What is read is 18 bytes a vertex and mode and 12 a vertex and product, a third of what
/// the shell needs.
///
///   V  vertices of the skin     W  nodes of its shell (shell_table.h)     n  modes     m  states
#pragma once

#include "palpable/common/material/simd.h"
#include "palpable/common/response/shell_table.h"

#include <Eigen/Core>

#include <memory>
#include <span>

namespace palpable {

/// States in which loads bring a body, and how much of each is in any other.
struct LoadStates {
  Eigen::MatrixXf states;  ///< (n x m) amplitudes
  Eigen::MatrixXf duals;   ///< (m x n) duals * states = 1
};

class ModalStress {
 public:
  /// Whether a table's stress can be told so: it has one material and no preload.
  [[nodiscard]] static bool serves(const ShellTable& table);

  /// Gradients are kept in 16 bits: each is off by 1.5e-5 of its mode's largest around, at most.
  /// @param table        @pre trouble_of(table, V) is empty, and serves(table)
  /// @param modes        (3V x n) m, of the skin
  /// @param inner_modes  (3 (W - V) x n) m, of the shell's other nodes
  /// @param loads        m may be 0
  ModalStress(const ShellTable& table, const Eigen::MatrixXf& modes,
              const Eigen::MatrixXf& inner_modes, const LoadStates& loads,
              SimdLevel level = best_simd_level());
  ~ModalStress();
  ModalStress(ModalStress&&) noexcept;

  /// Allocates nothing; the same amplitudes give the same bytes on every processor. Bounds as
  /// ShellStress has them: nothing that comes out is NaN.
  /// @param q          (n)
  /// @param von_mises  (V) Pa
  /// @param cauchy     (6V) Pa, xx yy zz xy yz zx of each vertex; empty: not wanted
  void evaluate(std::span<const float> q, std::span<float> von_mises, std::span<float> cauchy = {});

 private:
  void add_squares(const ShellTable& table, const Eigen::MatrixXf& modes,
                   const Eigen::MatrixXf& inner_modes, const LoadStates& loads);
  [[nodiscard]] float largest_gradient(const Eigen::VectorXf& q) const;

  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace palpable
