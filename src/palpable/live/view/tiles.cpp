#include "palpable/live/view/tiles.h"

#include "palpable/common/base/contract.h"
#include "palpable/live/render/text.h"

#include <algorithm>
#include <cstdint>

namespace palpable {
namespace {

constexpr Rgb kSeen{255, 255, 255}, kNotSeen{0, 0, 0}, kOtherwise{220, 30, 30};
constexpr int kMostInRow = 3;

}  // namespace

void draw_mask(const MaskImage& visible, ColorImage& picture) {
  picture.resize(visible.width(), visible.height());
  std::transform(visible.begin(), visible.end(), picture.begin(),
                 [](std::uint8_t value) { return value != 0 ? kSeen : kNotSeen; });
}

void draw_true_mask(const MaskImage& visible, const DepthImage& body_depth,
                    const DepthImage& true_depth, ColorImage& picture) {
  picture.resize(visible.width(), visible.height());
  const int factor = std::max(visible.width() / std::max(true_depth.width(), 1), 1);
  PALPABLE_EXPECT(true_depth.width() >= visible.width() / factor &&
                      true_depth.height() >= visible.height() / factor,
                  "the true depth is of the picture's size or half of it");
  for (int y = 0; y < picture.height(); ++y) {
    const int v = std::min(y / factor, true_depth.height() - 1);
    for (int x = 0; x < picture.width(); ++x) {
      const float real = true_depth(std::min(x / factor, true_depth.width() - 1), v);
      const float body = body_depth(x, y);
      const bool truly = body > 0 && !(real < body);
      const bool found = visible(x, y) != 0;
      picture(x, y) = truly != found ? kOtherwise : truly ? kSeen : kNotSeen;
    }
  }
}

void put_tile(const ColorImage& picture, int number, int count, const char* name,
              ColorImage& sheet) {
  PALPABLE_EXPECT(number >= 0 && number < count, "one of the tiles");
  const int columns = count <= kMostInRow ? count : (count + 1) / 2;
  const int width = picture.width() / 4 * 2, height = picture.height() / 4 * 2;
  if (number == 0) {
    sheet.resize(columns * width, (count + columns - 1) / columns * height);
    std::fill(sheet.begin(), sheet.end(), Rgb{});
  }
  const int left = number % columns * width, top = number / columns * height;
  for (int y = 0; y < height; ++y) {
    const Rgb* upper = picture.row(2 * y);
    const Rgb* lower = picture.row(2 * y + 1);
    Rgb* to = sheet.row(top + y) + left;
    for (int x = 0; x < width; ++x) {
      const auto mean = [&](std::uint8_t Rgb::*of) {
        const int sum =
            upper[2 * x].*of + upper[2 * x + 1].*of + lower[2 * x].*of + lower[2 * x + 1].*of;
        return static_cast<std::uint8_t>((sum + 2) / 4);
      };
      to[x] = {mean(&Rgb::r), mean(&Rgb::g), mean(&Rgb::b)};
    }
  }
  const float size = std::clamp(static_cast<float>(height) / 20, 10.0F, 42.0F);
  const TextSize text = measure_text(name, size);
  const auto x = static_cast<float>(left) + size / 2, y = static_cast<float>(top) + size / 2;
  fill_panel(sheet, x, y, text.width + size, text.height() + size / 2, size / 4, {0, 0, 0}, 0.6F);
  draw_text(sheet, x + size / 2, y + size / 4, name, size, {255, 255, 255});
}

}  // namespace palpable
