/// @file
/// Explanations drawn on a picture: the colour bar of the painted field, and lines of text.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/live/render/color_map.h"

#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// A bar with the colours of color_map.h, labelled with round numbers.
struct Legend {
  std::string_view title;  ///< the painted field, e.g. "von Mises stress"
  std::string_view unit;   ///< of the numbers, e.g. "kPa"
  double top = 1;          ///< number at the upper end, > 0
  bool two_sided = false;  ///< the lower end is -top, in the colours for two signs; else 0
  ColorScale colors = ColorScale::kBlueYellow;  ///< unless two-sided
  Rgb material = {};  ///< colour of the material below the scale's colours (color_map.h)
  float opaque = 0;   ///< share of the scale from which they cover it; 0: everywhere
  /// The largest value on the bodies now, in the legend's unit. The bar has a mark at it and the
  /// number below; a value that would be written as 0.0 gets neither. NaN: the panel is shorter,
  /// without lines for these numbers.
  double present = std::numeric_limits<double>::quiet_NaN();
  double present_least = std::numeric_limits<double>::quiet_NaN();  ///< the least, if two-sided
  double stated_error = 0;         ///< of the model, relative, 1 = 100 %; 0: not known
  std::string_view error_of = {};  ///< quantity of the error; empty: that of `present`
  float scale = 1;                 ///< factor of all lengths; 1 suits a picture of 720 rows
};

/// Draws the bar on a translucent panel at the right edge, centred in height. Letters have a least
/// size. In a picture of fewer than kSmallPicture rows, the panel therefore holds only what is
/// needed to read the bar: unit, three numbers, the mark; it then covers about 4 % of the picture.
void draw_legend(ColorImage& picture, const Legend& legend);

inline constexpr int kSmallPicture = 300;  // rows

/// Legend::scale for a picture with this many rows; letters stay legible in small pictures.
[[nodiscard]] float legend_scale(int rows);

/// Draws lines of text on a translucent panel in the lower left corner. A line that is wider than
/// the picture is broken, if possible at three spaces, else at one.
void draw_caption(ColorImage& picture, std::span<const std::string> lines, float scale);

/// Draws a line of text with its top left corner at (x, y) px on a translucent panel around it.
/// @param size  of the letters, px per em
void draw_label(ColorImage& picture, float x, float y, std::string_view text, float size);

/// Draws one line on a red panel at the middle of the top: something that the user has to act on. A
/// line that does not fit gets smaller letters, and is then broken.
void draw_warning(ColorImage& picture, std::string_view text, float scale);

/// Round numbers from 0 to at most `top` (> 0), about `wanted` of them, in steps of 1, 2 or 5 times
/// a power of ten.
[[nodiscard]] std::vector<double> round_ticks(double top, int wanted);

}  // namespace palpable
