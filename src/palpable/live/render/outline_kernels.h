/// @file
/// The sums over one window of RealOutlines (outlines.h), its inner loop. There is a plain version
/// and one for each set of vector instructions; all make the same operations in the same order,
/// none of them contracted (a * b + c is two roundings), and so give the same bytes.
#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace palpable {

/// A window of the lattice around one pixel: rows of kColumns lattice pixels.
struct OutlineWindow {
  static constexpr int kLanes = 8;     ///< columns that are added up apart
  static constexpr int kColumns = 16;  ///< a multiple of kLanes

  /// Of the window's first lattice pixel. `sure` is 1 or 0; light, warm, pink
  /// are coordinates of a colour (outlines.h); inverse 1/m, 0
  /// where the pixel is not sure; `moving` is 1 or 0, and 0 where it is not sure.
  const float *sure = nullptr, *light = nullptr, *warm = nullptr, *pink = nullptr,
              *inverse = nullptr, *moving = nullptr;
  std::size_t stride = 0;  ///< from one row of the lattice to the next
  int rows = 0;            ///< of the window
  float dx = 0, dy = 0;    ///< px from the pixel to the first lattice pixel
  float step = 0;          ///< px between lattice pixels
  float own_light = 0, own_warm = 0, own_pink = 0;  ///< of the pixel
};

using OutlineLanes = std::array<float, OutlineWindow::kLanes>;

/// By lane: sums of s g, s, s / Z and s where something moves, of the header's formula, over what
/// is nearer than 1 / split and over all.
struct OutlineSums {
  OutlineLanes near_fit, near_weight, near_inverse, near_moving;
  OutlineLanes all_fit, all_weight, all_inverse, all_moving;
};

struct OutlineKernels {
  const char* name = "";
  OutlineSums (*sums)(const OutlineWindow& window, float split);
};

/// All kernels that this processor can run, the fastest first and the plain one last.
[[nodiscard]] std::span<const OutlineKernels> outline_kernels();

}  // namespace palpable
