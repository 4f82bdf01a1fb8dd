/// @file
/// Sparse Cholesky factors of symmetric positive definite block matrices, as preconditioners.
///
/// Order of elimination and structure come from METIS and CHOLMOD, once for all matrices of a
/// pattern. The numbers are computed in single precision (supernodal, left-looking, on BLAS). For
/// compact bodies they are kept in 16 bits: a solve costs its bytes, and on the bunny of 16,000
/// nodes a path took 259 iterations with 8 bits of mantissa where it took 248 with 24. For slender
/// or nearly incompressible ones, whose stiffnesses differ by more than 8 bits can carry, in 32.
///
/// CHOLMOD keeps its settings and scratch memory in a "common" object that one thread may use at a
/// time; a finished factor may be read by many. So: one FactorWorkspace per thread (or per call),
/// CholeskyFactor objects shared as const.
#pragma once

#include "palpable/solid/block_matrix.h"

#include <Eigen/Core>

#include <cstddef>
#include <memory>
#include <optional>
#include <span>

namespace palpable {

/// Scratch memory for factorising and solving. Not to be used by two threads at once.
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
  /// Costs an ordering of the node graph (METIS), 30 ms for 4,000 nodes.
  /// @throws Error if memory runs out
  CholeskyAnalysis(const BlockPattern& pattern, FactorWorkspace& workspace);

  struct Content;
  [[nodiscard]] const Content& content() const { return *content_; }

  /// Nonzeros of L, zeros inside its panels included.
  [[nodiscard]] double nonzeros() const;
  /// Floating-point operations of one factorisation.
  [[nodiscard]] double factor_flops() const;

 private:
  friend class CholeskyFactor;
  friend class ExactFactor;
  std::shared_ptr<const Content> content_;
};

/// L L^T = P K P^T in double precision by CHOLMOD: K^-1 itself, for who solves many systems with
/// one matrix and builds upon the answers. 8 bytes a nonzero; a solve of 16 systems together costs
/// about as much as four alone.
class ExactFactor {
 public:
  /// @throws Error if K is not positive definite or memory runs out
  ExactFactor(const CholeskyAnalysis& analysis, const BlockMatrix& K, FactorWorkspace& workspace);

  /// B becomes K^-1 B, column by column. @throws Error if memory runs out
  void solve(Eigen::MatrixXd& B, FactorWorkspace& workspace) const;

 private:
  std::shared_ptr<const void> factor_;  // CHOLMOD's, which frees itself
};

/// In which a factor is kept.
enum class FactorPrecision { k16Bits, k32Bits };

/// L with L L^T ~= P K P^T.
class CholeskyFactor {
 public:
  /// The factor of K, or nothing if K is not positive definite. Where single precision breaks down
  /// before K does, double precision (CHOLMOD) is tried.
  /// @throws Error if memory runs out
  static std::optional<CholeskyFactor> make(const CholeskyAnalysis& analysis, const BlockMatrix& K,
                                            FactorPrecision precision, FactorWorkspace& workspace);

  /// x ~= K^-1 b: b and x are of the size of the matrix, and the map from b to x is symmetric and
  /// positive definite. Several threads may do so at once, each with its own workspace. Allocates
  /// only the first time that a workspace is used with a size.
  void solve_roughly(const Eigen::VectorXd& b, Eigen::VectorXd& x,
                     FactorWorkspace& workspace) const;

  /// How many systems solve_together() takes at most.
  static constexpr int kMostTogether = 16;
  /// solve_roughly() of up to 16 systems in one pass through the factor, which takes about as long
  /// as two of them alone: the numbers of L are read once for all. What comes out for a system is
  /// the same to the bit whatever the others are and however many, and solve_roughly()'s answer up
  /// to rounding.
  /// @param b, x  as many of each; none of x is one of b
  void solve_together(std::span<const Eigen::VectorXd* const> b,
                      std::span<Eigen::VectorXd* const> x, FactorWorkspace& workspace) const;

  /// Rows of the matrix.
  [[nodiscard]] Eigen::Index size() const;
  /// What a solve reads, twice.
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Content;
  explicit CholeskyFactor(std::shared_ptr<const Content> content) : content_(std::move(content)) {}
  std::shared_ptr<const Content> content_;
};

}  // namespace palpable
