/// @file
/// The true stress on a body's skin in any state whose displacement is known at the nodes of its
/// shell (shell_table.h): the law is evaluated at each point of each element, and the full solver's
/// recovery gives the stress at the vertices. The only error is that of the displacement.
///
///     F = 1 + sum_a (preload_a + u_a) (dN_a/dX)^T      sigma = P(F) F^T / J
///     sigma at a vertex = sum_k weights_k sigma at point k
///
///   V  vertices of the skin     W  nodes of the shell
#pragma once

#include "palpable/common/response/shell_table.h"

#include <Eigen/Core>

#include <memory>
#include <span>

namespace palpable {

class ShellStress {
 public:
  /// @pre trouble_of(table, vertices) is empty; the table is not needed afterwards
  ShellStress(const ShellTable& table, int vertices);
  ~ShellStress();
  ShellStress(ShellStress&&) noexcept;

  /// Allocates nothing; the same displacement gives the same bytes on every processor. An element
  /// that is compressed to less than a hundredth of its volume, or turned inside out, has the
  /// stress of a hundredth. No result is NaN, for any u.
  /// @param u          (3 x W) m, from the state without contact
  /// @param von_mises  (V) Pa
  /// @param cauchy     (6V) Pa, xx yy zz xy yz zx of each vertex; empty: not computed
  void evaluate(const Eigen::Matrix3Xf& u, std::span<float> von_mises,
                std::span<float> cauchy = {});

  [[nodiscard]] int vertices() const;
  [[nodiscard]] int nodes() const;

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace palpable
