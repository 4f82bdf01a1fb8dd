#include "palpable/live/render/picture_sheet.h"

#include <algorithm>

namespace palpable {
namespace {

// Copies a picture into a larger one.
void paste(const ColorImage& from, int x, int y, ColorImage& to) {
  for (int row = 0; row < from.height(); ++row) {
    std::copy_n(from.row(row), from.width(), to.row(y + row) + x);
  }
}

}  // namespace

ColorImage sheet_of(const std::vector<ColorImage>& cells, int columns) {
  constexpr int kGap = 8;
  const int width = cells[0].width() + kGap, height = cells[0].height() + kGap;
  const int count = static_cast<int>(cells.size());
  const int rows = (count + columns - 1) / columns;
  ColorImage sheet(columns * width + kGap, rows * height + kGap, {255, 255, 255});
  for (int i = 0; i < count; ++i) {
    paste(cells[i], kGap + i % columns * width, kGap + i / columns * height, sheet);
  }
  return sheet;
}

}  // namespace palpable
