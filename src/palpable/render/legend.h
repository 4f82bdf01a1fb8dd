/// @file
/// What explains a picture: the colour bar of the stress, lines of text.
#pragma once

#include "palpable/geometry/image.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// A bar of the colours of color_map with round numbers at it.
struct Legend {
  std::string_view title;  ///< what is painted, e.g. "von Mises stress"
  std::string_view unit;   ///< of the numbers, e.g. "kPa"
  double top = 1;          ///< the number at the upper end, > 0; the lower end is 0
  float scale = 1;         ///< of all lengths; 1 suits a picture of 720 rows
};

/// Draws it on a translucent panel at the right edge, centred in height.
void draw_legend(ColorImage& picture, const Legend& legend);

/// The scale that suits a picture of so many rows: letters stay legible in small ones.
[[nodiscard]] float legend_scale(int rows);

/// Draws lines of text on a translucent panel in the lower left corner.
void draw_caption(ColorImage& picture, std::span<const std::string> lines, float scale);

/// Draws one line on a red panel at the top, in the middle: what the user has to do something
/// about. The letters become smaller where it would not fit.
void draw_warning(ColorImage& picture, std::string_view text, float scale);

/// Round numbers from 0 to at most `top`, about `wanted` of them: steps of 1, 2 or 5 times a power
/// of ten. For top > 0.
[[nodiscard]] std::vector<double> round_ticks(double top, int wanted);

}  // namespace palpable
