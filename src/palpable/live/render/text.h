/// @file
/// Draws text and plain shapes with soft edges into a picture in memory. The font is DejaVu Sans at
/// a few sizes.
///
/// Positions are px from the picture's top left corner. Parts outside of the picture are cut off.
#pragma once

#include "palpable/common/geometry/image.h"

#include <string_view>

namespace palpable {

/// Size of a line of text, px.
struct TextSize {
  float width = 0;
  float ascent = 0;   ///< above the baseline
  float descent = 0;  ///< below it
  [[nodiscard]] float height() const { return ascent + descent; }
};

/// Measures one line of UTF-8 text.
/// @param size  px per em; the nearest available size (10 .. 42) is used
[[nodiscard]] TextSize measure_text(std::string_view text, float size);

/// Draws one line of UTF-8 text with its top left corner at (x, y). The font has ASCII, degree,
/// plus-minus, squared, cubed, micro, middle dot and multiply; any other letter becomes '?'.
void draw_text(ColorImage& picture, float x, float y, std::string_view text, float size, Rgb color,
               float opacity = 1.0f);

/// Fills a rectangle with rounded corners.
void fill_panel(ColorImage& picture, float x, float y, float width, float height, float radius,
                Rgb color, float opacity = 1.0f);

}  // namespace palpable
