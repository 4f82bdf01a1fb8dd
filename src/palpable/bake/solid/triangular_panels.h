/// @file
/// A sparse lower triangular matrix in 16 or 32 bits a number, and solves with it. Their time is
/// that of reading the matrix from memory.
///
/// The columns are grouped into supernodes: runs of columns that have the same rows below them. A
/// supernode is stored as one dense panel, column by column, whose first rows are its own columns.
#pragma once

#include "palpable/common/material/simd.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace palpable {

/// The upper half of a float: the same range, 8 bits of mantissa.
using BFloat16 = std::uint16_t;

/// Supernode k of n columns in S supernodes.
struct Supernodes {
  std::span<const int> first_column;  ///< (S + 1) increasing from 0 to n
  std::span<const int> first_row;     ///< (S + 1) places in `rows`
  std::span<const int> rows;          ///< those of panel k begin at first_row[k]; increasing
};

/// @tparam Stored  BFloat16 or float
template <class Stored>
class TriangularPanels {
 public:
  TriangularPanels() = default;
  /// Room for the panels, all zero.
  /// @param supernodes  must outlive the object
  explicit TriangularPanels(const Supernodes& supernodes);

  /// Sets panel k, rounding its numbers.
  /// @param values  rows x columns of supernode k, column by column; above the diagonal ignored
  template <class Number>
  void set(int k, const Number* values);

  /// In place: y = L^-1 y, then y = L^-T y, in single precision.
  /// @param y        (n)
  /// @param scratch  at least scratch_size()
  void solve(SimdLevel simd, std::span<float> y, std::span<float> scratch) const;
  [[nodiscard]] std::size_t scratch_size() const { return scratch_size_; }

  static constexpr int kSystems = 16;  ///< vectors of one solve_together()
  /// The same for kSystems vectors, stored entry by entry: first the kSystems numbers of entry 0,
  /// and so on. Each vector is one lane of the arithmetic, so its result does not depend on the
  /// others. It differs from the result of solve() by rounding, because sums have another order.
  /// @param y        (n * kSystems), aligned to 64 bytes
  /// @param scratch  at least scratch_size() * kSystems, aligned to 64 bytes
  void solve_together(SimdLevel simd, std::span<float> y, std::span<float> scratch) const;

  [[nodiscard]] std::size_t bytes() const {
    return values_.size() * sizeof(Sixteen) + inverse_diagonal_.size() * sizeof(float);
  }

 private:
  struct Solve;
  struct SolveTogether;
  // The operand of one vector instruction, aligned so that it lies within one cache line.
  static constexpr int kWidth = 16;
  struct alignas(kWidth * sizeof(Stored)) Sixteen {
    Stored of[kWidth];
  };
  // Columns are padded so that each begins with a Sixteen.
  static constexpr int padded(int rows) { return (rows + kWidth - 1) / kWidth * kWidth; }
  [[nodiscard]] const Stored* panel(int k) const { return values_[start_[k]].of; }
  [[nodiscard]] Stored* panel(int k) { return values_[start_[k]].of; }

  Supernodes supernodes_;
  std::vector<std::size_t> start_;  // (S) of each panel in values_
  std::vector<Sixteen> values_;     // strictly below the diagonal; zeros elsewhere
  std::vector<float> inverse_diagonal_;
  std::size_t scratch_size_ = 0;
};

}  // namespace palpable
