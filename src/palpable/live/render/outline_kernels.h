/// @file
/// The sums over one window, which is the inner loop of RealOutlines (outlines.h). There is a plain
/// version and one for each set of vector instructions; all do the same operations in the same
/// order, none of them contracted (a * b + c is rounded twice), and so give the same bytes.
#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace palpable {

/// A window of the lattice around one pixel: rows of kColumns lattice pixels.
struct OutlineWindow {
  static constexpr int kLanes = 8;     ///< columns with sums of their own
  static constexpr int kColumns = 16;  ///< a multiple of kLanes

  /// Point to the window's first lattice pixel. `sure` is 1 or 0; `light`, `warm`, `pink` are the
  /// coordinates of a colour (outlines.h); `inverse` is 1/Z in 1/m, and `moving` is 1 or 0, both 0
  /// where the pixel is not sure.
  const float *sure = nullptr, *light = nullptr, *warm = nullptr, *pink = nullptr,
              *inverse = nullptr, *moving = nullptr;
  std::size_t stride = 0;  ///< from one row of the lattice to the next
  int rows = 0;            ///< of the window
  float dx = 0, dy = 0;    ///< px from the pixel to the first lattice pixel
  float step = 0;          ///< px between lattice pixels
  float own_light = 0, own_warm = 0, own_pink = 0;  ///< colour of the middle pixel
};

using OutlineLanes = std::array<float, OutlineWindow::kLanes>;

/// Sums per lane of s g (fit), s (weight), s / Z (inverse), and s over moving pixels (moving), with
/// s and g of outlines.h: over pixels nearer than 1 / split (near), and over all pixels.
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
