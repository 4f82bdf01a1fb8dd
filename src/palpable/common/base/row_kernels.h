/// @file
/// The inner loops of the response to touch: sums and dot products over rows of 16-bit numbers,
/// once plain and once for each set of vector instructions. All give the same bytes: a dot product
/// is always made of 16 partial sums that are added up in the same order, and multiplications and
/// additions are not fused.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace palpable {

/// The length of a row is a multiple of this.
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

  /// sum_k += sum_i weight_i rows_(i, k), i rising: the same as add() for one row after the other,
  /// but with the sums in registers. @param stride  numbers between the beginnings of two rows
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

/// The kernels that this processor can run, the fastest first and the plain ones last. They are
/// found when the program starts, so that one program runs on every processor.
[[nodiscard]] std::span<const RowKernels> row_kernels();
/// The best of them.
[[nodiscard]] inline const RowKernels& best_row_kernels() { return row_kernels().front(); }

}  // namespace palpable
