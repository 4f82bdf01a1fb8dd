/// @file
/// Letters and plain shapes on a picture in memory, with soft edges. DejaVu Sans at a few sizes.
///
/// Positions are in px from the picture's top left corner; what falls outside is cut off.
#pragma once

#include "palpable/geometry/image.h"

#include <string_view>

namespace palpable {

/// Lengths of a line of text, px.
struct TextSize {
  float width = 0;
  float ascent = 0;   ///< above the baseline
  float descent = 0;  ///< below it
  [[nodiscard]] float height() const { return ascent + descent; }
};

/// @param size  px per em; the nearest size that exists (10 .. 42) is taken
[[nodiscard]] TextSize measure_text(std::string_view text, float size);

/// Draws one line of UTF-8 text with its top left corner at (x, y). A letter that the font has not
/// (beyond ASCII: degree, plus-minus, squared, cubed, micro, middle dot, multiply) becomes '?'.
void draw_text(ColorImage& picture, float x, float y, std::string_view text, float size, Rgb color,
               float opacity = 1.0f);

/// Fills a rectangle with rounded corners.
void fill_panel(ColorImage& picture, float x, float y, float width, float height, float radius,
                Rgb color, float opacity = 1.0f);

}  // namespace palpable
