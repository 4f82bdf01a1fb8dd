#include "palpable/live/render/text.h"

#include "palpable/live/render/font_table.h"
#include "palpable/live/render/mix_color.h"

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

using detail::FontSize;
using detail::Glyph;

const FontSize& nearest_size(float size) {
  const auto sizes = detail::font_table().sizes;
  return *std::min_element(sizes.begin(), sizes.end(), [&](const FontSize& a, const FontSize& b) {
    return std::abs(static_cast<float>(a.size) - size) <
           std::abs(static_cast<float>(b.size) - size);
  });
}

const Glyph& glyph_of(const FontSize& size, int letter) {
  const auto glyphs = detail::font_table().glyphs.subspan(size.first, size.count);
  const auto found = std::lower_bound(glyphs.begin(), glyphs.end(), letter,
                                      [](const Glyph& g, int c) { return g.letter < c; });
  if (found != glyphs.end() && found->letter == letter) return *found;
  return glyph_of(size, '?');
}

/// Removes the first letter of a UTF-8 text and returns it; U+FFFD for bytes that are not UTF-8.
int take_letter(std::string_view& text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const int first = byte(0);
  const std::size_t length = first < 0x80   ? 1
                             : first < 0xc0 ? 0
                             : first < 0xe0 ? 2
                             : first < 0xf0 ? 3
                                            : 4;
  int letter = length == 1 ? first : length == 0 ? 0xfffd : first & (0x7f >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if (i >= text.size() || (byte(i) & 0xc0) != 0x80) {
      text.remove_prefix(i);
      return 0xfffd;
    }
    letter = (letter << 6) | (byte(i) & 0x3f);
  }
  text.remove_prefix(std::max<std::size_t>(length, 1));
  return letter;
}

}  // namespace

TextSize measure_text(std::string_view text, float size) {
  const FontSize& font = nearest_size(size);
  float width = 0;
  while (!text.empty()) width += glyph_of(font, take_letter(text)).advance;
  return {width, font.ascent, font.descent};
}

void draw_text(ColorImage& picture, float x, float y, std::string_view text, float size, Rgb color,
               float opacity) {
  const FontSize& font = nearest_size(size);
  const auto ink = detail::font_table().ink;
  float pen = x;
  const int baseline = static_cast<int>(std::lround(y + font.ascent));
  while (!text.empty()) {
    const Glyph& glyph = glyph_of(font, take_letter(text));
    const int left = static_cast<int>(std::lround(pen)) + glyph.left;
    const int top = baseline + glyph.top;
    for (int v = std::max(0, -top); v < std::min(glyph.height, picture.height() - top); ++v) {
      for (int u = std::max(0, -left); u < std::min(glyph.width, picture.width() - left); ++u) {
        const auto at = glyph.ink + v * glyph.width + u;
        mix_color(picture(left + u, top + v), color,
                  opacity * static_cast<float>(ink[at]) / 255.0f);
      }
    }
    pen += glyph.advance;
  }
}

void fill_panel(ColorImage& picture, float x, float y, float width, float height, float radius,
                Rgb color, float opacity) {
  const float r = std::min({radius, 0.5f * width, 0.5f * height});
  const float cx = x + 0.5f * width, cy = y + 0.5f * height;
  const int y0 = std::max(static_cast<int>(std::floor(y)), 0);
  const int y1 = std::min(static_cast<int>(std::ceil(y + height)), picture.height());
  const int x0 = std::max(static_cast<int>(std::floor(x)), 0);
  const int x1 = std::min(static_cast<int>(std::ceil(x + width)), picture.width());
  for (int v = y0; v < y1; ++v) {
    for (int u = x0; u < x1; ++u) {
      // Distance to the outline, px, negative inside. The outline is soft over one pixel.
      const float dx = std::abs(static_cast<float>(u) + 0.5f - cx) - 0.5f * width + r;
      const float dy = std::abs(static_cast<float>(v) + 0.5f - cy) - 0.5f * height + r;
      const float outside =
          std::hypot(std::max(dx, 0.0f), std::max(dy, 0.0f)) + std::min(std::max(dx, dy), 0.0f) - r;
      const float cover = std::clamp(0.5f - outside, 0.0f, 1.0f);
      if (cover > 0.0f) mix_color(picture(u, v), color, opacity * cover);
    }
  }
}

}  // namespace palpable
