/// @file
/// The inner loops of touching: sums and dot products over rows of numbers kept in 16 bits, once
/// plain and once vectorised. All give the same bytes: a dot product is always 16 partial sums that
/// are added up at the end in one order, and nothing is fused.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace palpable {

/// Rows have a multiple of this many numbers.
inline constexpr std::size_t kRowStep = 16;

/// n, rounded up to whole steps.
[[nodiscard]] constexpr std::size_t padded(std::size_t n) {
  return (n + kRowStep - 1) / kRowStep * kRowStep;
}

struct RowKernels {
  const char* name = "";

  /// sum_k += weight * row_k
  void (*add)(const std::int16_t* row, float weight, std::span<float> sum);
  /// The same for a row of floats.
  void (*add_floats)(const float* row, float weight, std::span<float> sum);

  /// sum_k += sum_i weight_i rows_(i, k), i rising: as add() for one row after the other, with
  /// the sums kept in registers. @param stride  numbers from one row's beginning to the next one's
  void (*add_rows)(const std::int16_t* rows, std::size_t stride, std::span<const float> weights,
                   std::span<float> sum);
  /// The same for rows of floats.
  void (*add_float_rows)(const float* rows, std::size_t stride, std::span<const float> weights,
                         std::span<float> sum);

  /// result_i = sum_k rows_(i, k) vector_k, for `count` rows one after the other.
  void (*dots)(const std::int16_t* rows, std::size_t count, std::span<const float> vector,
               float* result);
  /// The same for rows of floats.
  void (*dots_floats)(const float* rows, std::size_t count, std::span<const float> vector,
                      float* result);
};

/// All that this processor can run, the best first and the plain ones last. Chosen when the program
/// runs, so that one program runs everywhere.
[[nodiscard]] std::span<const RowKernels> row_kernels();
/// The best of them.
[[nodiscard]] inline const RowKernels& best_row_kernels() { return row_kernels().front(); }

}  // namespace palpable
