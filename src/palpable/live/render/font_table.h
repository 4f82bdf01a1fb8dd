/// @file
/// The built-in font as tools/make_font.cpp writes it. text.cpp and panel.cpp read it.
#pragma once

#include <span>

namespace palpable::detail {

/// One letter at one size. The top left corner of its bitmap lies (left, top) px from the pen,
/// which stands on the baseline; y down.
struct Glyph {
  int letter;     ///< Unicode
  int left, top;  ///< px
  int width, height;
  float advance;  ///< px to the next letter
  long ink;       ///< index of its bitmap in FontTable::ink; row-major coverage, 0..255
};

/// All letters at one size.
struct FontSize {
  int size;       ///< px per em
  float ascent;   ///< px above the baseline
  float descent;  ///< px below it
  int first;      ///< index of its first glyph
  int count;      ///< glyphs of this size
};

/// The whole font. `ink` holds the bitmaps of all glyphs.
struct FontTable {
  std::span<const Glyph> glyphs;
  std::span<const FontSize> sizes;  ///< increasing
  std::span<const unsigned char> ink;
};

/// The font that is compiled into the program; valid for ever.
[[nodiscard]] FontTable font_table();

}  // namespace palpable::detail
