/// @file
/// Sparse Cholesky factors of symmetric positive definite block matrices, as preconditioners.
///
/// METIS and CHOLMOD find the order of elimination and the structure of the factor, once for all
/// matrices of a pattern. The factor is computed in single precision (supernodal, left-looking, on
/// BLAS) and stored in 16 or 32 bits a number. The time of a solve is that of reading the factor,
/// so 16 bits make it twice as fast; on the bunny of 16,000 nodes a path took 259 iterations with
/// them (8 bits of mantissa) and 248 with 32 (24 bits). Slender or nearly incompressible bodies,
/// whose stiffnesses differ by more than 8 bits can hold, need 32.
///
/// CHOLMOD keeps its settings and scratch memory in a "common" object, which only one thread may
/// use at a time; many threads may read a finished factor. So each thread (or call) has a
/// FactorWorkspace of its own, and CholeskyFactor objects are shared as const.
#pragma once

#include "palpable/bake/solid/block_matrix.h"

#include <Eigen/Core>

#include <cstddef>
#include <memory>
#include <optional>
#include <span>

namespace palpable {

/// Scratch memory for factorising and solving. Two threads must not use one at the same time.
class FactorWorkspace {
 public:
  FactorWorkspace();
  ~FactorWorkspace();
  FactorWorkspace(const FactorWorkspace&) = delete;
  FactorWorkspace& operator=(const FactorWorkspace&) = delete;

  struct Content;
  [[nodiscard]] Content& content() { return *content_; }

 private:
  std::unique_ptr<Content> content_;
};

/// What all matrices of one pattern share: the order of elimination and the structure of L.
class CholeskyAnalysis {
 public:
  /// Orders the node graph with METIS; 30 ms for 4,000 nodes.
  /// @throws Error if memory runs out
  CholeskyAnalysis(const BlockPattern& pattern, FactorWorkspace& workspace);

  struct Content;
  [[nodiscard]] const Content& content() const { return *content_; }

  /// Numbers that L stores, including zeros inside its panels.
  [[nodiscard]] double nonzeros() const;
  /// Floating-point operations of one factorisation.
  [[nodiscard]] double factor_flops() const;

 private:
  friend class CholeskyFactor;
  friend class ExactFactor;
  std::shared_ptr<const Content> content_;
};

/// L L^T = P K P^T in double precision by CHOLMOD, for callers that need K^-1 b to full precision
/// and not just a preconditioner. 8 bytes a nonzero. Solving 16 systems together costs about as
/// much as four of them alone.
class ExactFactor {
 public:
  /// @throws Error if K is not positive definite or memory runs out
  ExactFactor(const CholeskyAnalysis& analysis, const BlockMatrix& K, FactorWorkspace& workspace);

  /// B becomes K^-1 B, column by column. @throws Error if memory runs out
  void solve(Eigen::MatrixXd& B, FactorWorkspace& workspace) const;

 private:
  std::shared_ptr<const void> factor_;  // a cholmod_factor; its deleter frees it
};

/// Bits for each number of a stored factor.
enum class FactorPrecision { k16Bits, k32Bits };

/// L with L L^T ~= P K P^T.
class CholeskyFactor {
 public:
  /// The factor of K, or nothing if K is not positive definite. Where single precision breaks
  /// down, CHOLMOD tries again in double precision.
  /// @throws Error if memory runs out
  static std::optional<CholeskyFactor> make(const CholeskyAnalysis& analysis, const BlockMatrix& K,
                                            FactorPrecision precision, FactorWorkspace& workspace);

  /// x ~= K^-1 b, both of the matrix' size. The map from b to x is symmetric and positive definite.
  /// Several threads may call this at once, each with its own workspace. Allocates only at the
  /// first use of a workspace with this size.
  void solve_roughly(const Eigen::VectorXd& b, Eigen::VectorXd& x,
                     FactorWorkspace& workspace) const;

  /// Most systems of one solve_together().
  static constexpr int kMostTogether = 16;
  /// solve_roughly() of up to 16 systems in one pass through the factor. It reads the numbers of L
  /// once for all systems, and so takes about as long as two of them alone. The result for a system
  /// does not depend on the others or their number, to the bit; it differs from solve_roughly()'s
  /// by rounding.
  /// @param b, x  as many of each; none of x is one of b
  void solve_together(std::span<const Eigen::VectorXd* const> b,
                      std::span<Eigen::VectorXd* const> x, FactorWorkspace& workspace) const;

  /// Rows of the matrix.
  [[nodiscard]] Eigen::Index size() const;
  /// Size of the factor, bytes. A solve reads it twice.
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Content;
  explicit CholeskyFactor(std::shared_ptr<const Content> content) : content_(std::move(content)) {}
  std::shared_ptr<const Content> content_;
};

}  // namespace palpable
