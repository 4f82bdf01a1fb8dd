/// @file
/// A sparse symmetric matrix of 3 x 3 blocks with a pattern that never changes.
///
///   M  block rows = free nodes of a body; a vector has 3 M entries, x0 y0 z0 x1 ...
#pragma once

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// The blocks that exist, row by row. Both triangles are stored, so that a product reads memory
/// sequentially.
struct BlockPattern {
  std::vector<int> row_start;  ///< (M + 1)
  std::vector<int> column;     ///< ascending within a row

  [[nodiscard]] int rows() const { return static_cast<int>(row_start.size()) - 1; }
  [[nodiscard]] int blocks() const { return static_cast<int>(column.size()); }

  /// Number of block (row, column), -1 if the pattern lacks it. Takes time logarithmic in the
  /// length of the row.
  [[nodiscard]] int find(int row, int column) const;
};

/// The values that go with a pattern.
class BlockMatrix {
 public:
  /// All zero. @param pattern  must outlive the matrix
  explicit BlockMatrix(const BlockPattern& pattern);

  [[nodiscard]] const BlockPattern& pattern() const { return *pattern_; }

  void set_zero();

  /// Block number `index` of the pattern.
  [[nodiscard]] Eigen::Map<Eigen::Matrix3d> block(int index) {
    return Eigen::Map<Eigen::Matrix3d>(values_.data() + 9 * static_cast<std::size_t>(index));
  }
  [[nodiscard]] Eigen::Map<const Eigen::Matrix3d> block(int index) const {
    return Eigen::Map<const Eigen::Matrix3d>(values_.data() + 9 * static_cast<std::size_t>(index));
  }

  /// y = K x, both (3M).
  void multiply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const;

 private:
  const BlockPattern* pattern_;
  std::vector<double> values_;
};

}  // namespace palpable
