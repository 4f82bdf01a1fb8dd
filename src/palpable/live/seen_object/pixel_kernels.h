/// @file
/// The inner loops over the pixels of seen things (silhouette.h, creases.h), once plain and once
/// vectorised. All give the same bytes: nothing is added up in another order, nothing is fused.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace palpable {

/// Vectorised loops read, but never change, so many pixels of a row more than they are told to.
inline constexpr int kReadBeyond = 12;

/// Whether a pixel's depth was measured.
[[nodiscard]] inline bool is_depth(float z) { return std::isfinite(z) && z > 0.0f; }

/// From a pixel to the nearest pixel beyond the outline.
struct ToOutline {
  std::int16_t dx = 0;
  std::int16_t dy = 0;
};

/// What a silhouette knows of a row of pixels; all point at the same pixel. One pixel before it and
/// kReadBeyond after the last one may be read.
struct OutlineRow {
  float* distance = nullptr;     // px to the outline; 0: no thing
  ToOutline* nearest = nullptr;  // that outline
  float* beyond = nullptr;       // px by which it lies farther out than between pixels
  const float* depth = nullptr;  // m
};

/// The same, as far as distances go.
struct DistanceRow {
  const float* distance = nullptr;
  const float* depth = nullptr;
};

/// Neighbours of one surface differ by at most max(least, at_1m * Z^2).
struct DepthJump {
  float least = 0;  // m
  float at_1m = 0;  // 1/m
};

/// Columns of a window that are summed up at once: a fit's usual one is eleven wide.
inline constexpr int kWindowColumns = 12;

/// A part of a silhouette round one pixel.
struct PixelWindow {
  // Of its first pixel; kWindowColumns of each row may be read.
  const float* depth = nullptr;     // m
  const float* distance = nullptr;  // px
  std::size_t stride = 0;           // from row to row
  int columns = 0;                  // at most kWindowColumns
  int top = 0, bottom = 0;          // its first and last row, counted from the pixel's
  float z = 0;                      // m, the pixel's depth
  float least = 0;                  // px, > 0: pixels of a smaller distance do not count
  /// What a thing falls off from its middle, whose section is a circle of this radius, is taken
  /// out of the depths; 0: nothing is.
  float radius = 0;     // m
  float fattening = 0;  // px, by which the distances are too large
  float m_per_px = 0;   // at the middle
};

/// By column, of the pixels that count: with w = 1/Z less that of the middle pixel and v the row,
/// the sums of 1, v, v^2, w, v w, v^2 w.
struct ColumnSums {
  alignas(16) std::array<float, kWindowColumns> n, nv, nvv, w, vw, vvw;
};

/// px by which the distances of neighbours differ at most.
inline constexpr float kOutlineStep = 1.7f;

/// px, of an outline's length: see silhouette.cpp.
inline constexpr float kBeforeMiddle = 0.5f, kBeforeMiddleSlanted = 0.28f;

/// Which pixels' discs do not need a ball.
struct MiddleTest {
  float growth = 0;     // of the distance per px towards the middle, with which a disc is held
  float fattening = 0;  // px
  float f_r = 0;        // px m
  float r = 0;          // m
};

/// Where a chord through a place's neighbourhood may pass before it (creases.cpp).
struct ChordTest {
  float half_px_at_1m = 0;  // half a chord; px m
  int least_half_px = 0;
  float fx_px = 0;
  float eight_radii = 0;      // m, of the sphere that is as hollow as it must be
  float nearest_at_1m = 0;    // px m: places nearer to an outline are not asked
  int before = 0, after = 0;  // px of the row before the first pixel and after the last one
  int above = 0, below = 0;   // rows
};

struct PixelKernels {
  const char* name = "";

  /// Offers each of `count` pixels the outlines that are nearest to its three neighbours of the row
  /// `from`, which lies at dy, in the order of x.
  void (*take_over)(const OutlineRow& from, const OutlineRow& to, int dy, int count,
                    const DepthJump& jump);

  /// 1/m, of each of `count` pixels the mean over those of the nine round it that belong to its
  /// surface: 1/Z differs by less than jump.at_1m, or Z by less than jump.least. 0 where it is 0.
  /// The rows' first pixels; one pixel before and kReadBeyond after the last one may be read.
  void (*mean_of_nine)(const float* above, const float* row, const float* below, int count,
                       const DepthJump& jump, float* mean);

  /// Overwrites `sums`.
  void (*sum_window)(const PixelWindow& window, const DepthJump& jump, ColumnSums& sums);

  /// Of each of `count` pixels its distance if balls may stand there, else 0: of wide parts, with
  /// distance - fattening >= f_r / (Z + r), and where no neighbour's disc holds the pixel's
  /// (medial_balls.cpp).
  void (*find_middles)(const DistanceRow& above, const DistanceRow& row, const DistanceRow& below,
                       int count, const DepthJump& jump, const MiddleTest& test, float* distance);

  /// Of each of `count` pixels 1 if it may be hollow, else 0. With `mean` the inverse depths (1/m)
  /// of an image whose rows are `width` apart, 0 where no thing is.
  void (*find_hollow)(const float* mean, const float* distance, std::ptrdiff_t width, int count,
                      const ChordTest& test, float* hollow);
};

/// All that this processor can run, the best first and the plain ones last. Chosen when the program
/// runs, so that one program runs everywhere.
[[nodiscard]] std::span<const PixelKernels> pixel_kernels();
/// The best of them.
[[nodiscard]] inline const PixelKernels& best_pixel_kernels() { return pixel_kernels().front(); }

}  // namespace palpable
