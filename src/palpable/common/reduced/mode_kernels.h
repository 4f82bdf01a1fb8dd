/// @file
/// The inner loops of evaluation, once plain and once for each set of vector instructions. All give
/// the same bytes: each value is computed by the same multiplications and additions in the same
/// order, none fused.
#pragma once

#include <cstddef>
#include <span>

namespace palpable {

/// Some rows of several modes: column i begins at `first + i * stride`.
struct ModeColumns {
  const float* first = nullptr;
  std::size_t stride = 0;
  std::size_t count = 0;
};

struct ModeKernels {
  const char* name = "";

  /// u_k = sum_i weights_i F_ki, summed from the first column on. @param add  add to u instead of
  /// overwriting it
  void (*sum)(const ModeColumns& F, const float* weights, bool add, std::span<float> u);

  /// Von Mises stress, sqrt(3/2 s:s) with s the deviator.
  /// @param stress (6 x count) xx yy zz xy yz zx per vertex
  void (*von_mises)(const float* stress, std::span<float> result);

  /// Scales each of `count` vectors x y z to length 1; vectors of length 0 are unchanged.
  void (*normalise)(float* vectors, std::size_t count);
};

/// The kernels that this processor can run, the fastest first and the plain ones last. They are
/// found when the program starts, so that one program runs on every processor.
[[nodiscard]] std::span<const ModeKernels> mode_kernels();

}  // namespace palpable
