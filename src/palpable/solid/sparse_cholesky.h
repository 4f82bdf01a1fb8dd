/// @file
/// Sparse Cholesky factors of symmetric positive definite block matrices, by CHOLMOD (supernodal,
/// METIS ordering of the nodes).
///
/// CHOLMOD keeps its settings and scratch memory in a "common" object that one thread may use at a
/// time; a finished factor may be read by many. So: one FactorWorkspace per thread (or per call),
/// CholeskyFactor objects shared as const.
#pragma once

#include "palpable/solid/block_matrix.h"

#include <Eigen/Core>

#include <memory>
#include <optional>

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

  /// Nonzeros of L, counting each 8 bytes.
  [[nodiscard]] double nonzeros() const;

 private:
  std::shared_ptr<const Content> content_;
};

/// L with L L^T = P K P^T.
class CholeskyFactor {
 public:
  /// The factor of K, or nothing if K is not positive definite.
  /// @throws Error if memory runs out
  static std::optional<CholeskyFactor> make(const CholeskyAnalysis& analysis, const BlockMatrix& K,
                                            FactorWorkspace& workspace);

  /// x = K^-1 b. Several threads may do so at once, each with its own workspace. Allocates only
  /// the first time that a workspace is used with a size.
  void solve(const Eigen::VectorXd& b, Eigen::VectorXd& x, FactorWorkspace& workspace) const;

  /// x ~= K^-1 b to about six digits, with a copy of L in single precision: what preconditioning
  /// needs, at half the bytes, and bytes are its whole cost.
  void solve_roughly(const Eigen::VectorXd& b, Eigen::VectorXd& x,
                     FactorWorkspace& workspace) const;

 private:
  struct Content;
  explicit CholeskyFactor(std::shared_ptr<const Content> content) : content_(std::move(content)) {}
  std::shared_ptr<const Content> content_;
};

}  // namespace palpable
