/// @file
/// The inner loops over the pixels of seen things (silhouette.h, creases.h, medial_balls.h), in a
/// plain version and in vectorised ones. All versions give the same bytes: sums have the same
/// order, and no multiplication is fused with an addition. (find_hollow() may return more pixels.)
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace palpable {

/// Number of pixels after the end of a row that vectorised loops may read. They never change them.
inline constexpr int kReadBeyond = 12;

/// Whether a pixel's depth was measured.
[[nodiscard]] inline bool is_depth(float z) { return std::isfinite(z) && z > 0.0f; }

/// Number of steps per pixel in which a ToOutline is stored.
inline constexpr float kOutlineUnits = 16;

/// The offset from the middle of a pixel to the nearest point of the outline, in 1/16 px. In images
/// of more than 2,047 px a side an offset could overflow.
struct ToOutline {
  std::int16_t dx = 0;
  std::int16_t dy = 0;
};

/// The length of an offset, px.
[[nodiscard]] inline float length_of(ToOutline offset) {
  const auto dx = static_cast<float>(offset.dx), dy = static_cast<float>(offset.dy);
  return std::sqrt(dx * dx + dy * dy) * (1 / kOutlineUnits);
}

/// The data of a row of a silhouette; all pointers refer to the same pixel. One pixel before it and
/// kReadBeyond pixels after the last one may be read.
struct OutlineRow {
  float* distance = nullptr;     // px to the outline; 0: no thing
  ToOutline* nearest = nullptr;  // the nearest outline
  float* beyond = nullptr;  // px added to the length of that offset (Silhouette::known_better())
  const float* depth = nullptr;  // m
};

/// Distances and depths of an OutlineRow.
struct DistanceRow {
  const float* distance = nullptr;
  const float* depth = nullptr;
};

/// The largest difference in depth of neighbours of one surface, max(least, at_1m * Z^2).
struct DepthJump {
  float least = 0;  // m
  float at_1m = 0;  // 1/m
};

/// Columns of a window that are summed in one call. The usual window of a fit has eleven.
inline constexpr int kWindowColumns = 12;

/// A part of a silhouette around one pixel.
struct PixelWindow {
  // The window's first pixel; kWindowColumns pixels of each row may be read.
  const float* depth = nullptr;     // m
  const float* distance = nullptr;  // px
  std::size_t stride = 0;           // elements from one row to the next
  int columns = 0;                  // at most kWindowColumns
  int top = 0, bottom = 0;          // first and last row, relative to the middle pixel's
  float z = 0;                      // m, the middle pixel's depth
  float least = 0;                  // px, > 0: pixels with a smaller distance are left out
  /// From each depth, the amount is subtracted by which a section that is a circle of this radius
  /// recedes from its middle; 0: nothing is subtracted.
  float radius = 0;     // m
  float fattening = 0;  // px by which the distances are too large
  float m_per_px = 0;   // size of a pixel at the middle of the section
};

/// Sums per column over the pixels that count: of 1, v, v^2, w, v w, v^2 w, with v the row and
/// w = 1/Z - 1/Z of the middle pixel.
struct ColumnSums {
  alignas(16) std::array<float, kWindowColumns> n, nv, nvv, w, vw, vvw;
};

/// Bound of the difference of two neighbours' distances to the same outline, px: the diagonal of a
/// pixel.
inline constexpr float kOutlineStep = 1.4143f;

/// Parameters of find_middles().
struct MiddleTest {
  float growth = 0;     // px per px: kGrowth in medial_balls.cpp
  float fattening = 0;  // px by which the distances are too large
  float f_r = 0;        // px m, focal length times the largest radius of a ball
  float r = 0;          // m, that radius
};

/// Parameters of find_hollow(): a pixel is concave if a chord between two pixels on either side of
/// it passes before it (creases.cpp).
struct ChordTest {
  float half_px_at_1m = 0;    // px m: half a chord's length, times the depth
  int least_half_px = 0;      // px: lower bound of half a chord's length
  float fx_px = 0;            // focal length
  float eight_radii = 0;      // m: 8 times the radius of curvature below which a pixel is concave
  float nearest_at_1m = 0;    // px m: pixels nearer to an outline (times the depth) are left out
  int before = 0, after = 0;  // px of the row before the first pixel and after the last one
  int above = 0, below = 0;   // rows of the image above and below this one
};

struct PixelKernels {
  const char* name = "";

  /// Lets each of `count` pixels of the row `to` take over the outline of one of its three
  /// neighbours in the row `from`, if that is nearer than its own. @param dy  -1: `from` lies above
  /// `to`, 1: below
  void (*take_over)(const OutlineRow& from, const OutlineRow& to, int dy, int count,
                    const DepthJump& jump);

  /// Averages inverse depths (1/m): for each of `count` pixels the mean over those of the 3 x 3
  /// pixels that belong to its surface, whose 1/Z differs by less than jump.at_1m or whose Z
  /// differs by less than jump.least. 0 where the pixel itself is 0.
  /// @param above, row, below  the rows' first pixels; one pixel before them and kReadBeyond after
  ///                           the last one may be read
  void (*mean_of_nine)(const float* above, const float* row, const float* below, int count,
                       const DepthJump& jump, float* mean);

  /// Sums the pixels of a window. @param sums  overwritten
  void (*sum_window)(const PixelWindow& window, const DepthJump& jump, ColumnSums& sums);

  /// Writes for each of `count` pixels its distance if a ball may be placed there, else 0. Balls
  /// may be placed in wide parts, where distance - fattening >= f_r / (Z + r), and at pixels whose
  /// disc is not contained in a neighbour's disc (medial_balls.cpp).
  void (*find_middles)(const DistanceRow& above, const DistanceRow& row, const DistanceRow& below,
                       int count, const DepthJump& jump, const MiddleTest& test, float* distance);

  /// Writes 1 for each of `count` pixels that may be concave, else 0. Vectorised versions may write
  /// 1 for more pixels than the plain one, never for fewer.
  /// @param mean   1/m, inverse depths of an image; 0 where there is no thing
  /// @param width  elements from one row of `mean` to the next
  void (*find_hollow)(const float* mean, const float* distance, std::ptrdiff_t width, int count,
                      const ChordTest& test, float* hollow);
};

/// All kernels that this processor can run, the fastest first and the plain ones last. They are
/// found at run time, so that one program runs on every processor.
[[nodiscard]] std::span<const PixelKernels> pixel_kernels();
/// The fastest kernels.
[[nodiscard]] inline const PixelKernels& best_pixel_kernels() { return pixel_kernels().front(); }

}  // namespace palpable
