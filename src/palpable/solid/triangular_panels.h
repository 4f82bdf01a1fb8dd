/// @file
/// A sparse lower triangular matrix in 16 or 32 bits a number, and solving with it: the
/// preconditioner's whole cost is reading these bytes.
///
/// Columns come in supernodes: runs of columns with the same rows below them. A supernode is one
/// dense panel, column by column; its first rows are its own columns.
#pragma once

#include "palpable/solid/simd.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace palpable {

/// The upper half of a float: its range, 8 bits of its mantissa.
using BFloat16 = std::uint16_t;

/// Supernode k of n columns in S supernodes.
struct Supernodes {
  std::span<const int> first_column;  ///< (S + 1) increasing from 0 to n
  std::span<const int> first_row;     ///< (S + 1) places in `rows`
  std::span<const int> rows;          ///< of panel k from first_row[k] on, increasing
};

/// @tparam Stored  BFloat16 or float
template <class Stored>
class TriangularPanels {
 public:
  TriangularPanels() = default;
  /// Room for the panels, all zero.
  /// @param supernodes  must outlive the object
  explicit TriangularPanels(const Supernodes& supernodes);

  /// Takes over one panel, rounded.
  /// @param values  column by column, rows x columns of supernode k; above the diagonal ignored
  template <class Number>
  void set(int k, const Number* values);

  /// In place: y = L^-1 y, then y = L^-T y, in single precision.
  /// @param y        (n)
  /// @param scratch  at least scratch_size()
  void solve(SimdLevel simd, std::span<float> y, std::span<float> scratch) const;
  [[nodiscard]] std::size_t scratch_size() const { return scratch_size_; }

  static constexpr int kSystems = 16;
  /// The same for kSystems vectors side by side, each entry's kSystems numbers together. What comes
  /// out of one of them does not depend on the others: each is one lane of the arithmetic. (It
  /// differs from what solve() gives by rounding: sums are taken in another order.)
  /// @param y        (n * kSystems), aligned to 64 bytes
  /// @param scratch  at least scratch_size() * kSystems, aligned to 64 bytes
  void solve_together(SimdLevel simd, std::span<float> y, std::span<float> scratch) const;

  [[nodiscard]] std::size_t bytes() const {
    return values_.size() * sizeof(Sixteen) + inverse_diagonal_.size() * sizeof(float);
  }

 private:
  struct Solve;
  struct SolveTogether;
  // What one vector instruction works on; aligned, so that none straddles two cache lines.
  static constexpr int kWidth = 16;
  struct alignas(kWidth * sizeof(Stored)) Sixteen {
    Stored of[kWidth];
  };
  // Columns are padded so that each begins with a Sixteen.
  static constexpr int padded(int rows) { return (rows + kWidth - 1) / kWidth * kWidth; }
  [[nodiscard]] const Stored* panel(int k) const { return values_[start_[k]].of; }

  Supernodes supernodes_;
  std::vector<std::size_t> start_;  // (S) of each panel in values_
  std::vector<Sixteen> values_;     // strictly below the diagonal; zeros elsewhere
  std::vector<float> inverse_diagonal_;
  std::size_t scratch_size_ = 0;
};

}  // namespace palpable
