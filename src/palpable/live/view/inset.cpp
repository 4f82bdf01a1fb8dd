#include "palpable/live/view/inset.h"

#include "palpable/live/render/text.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace palpable {
namespace {

constexpr int kInset = 4;  // times smaller

}  // namespace

void draw_inset(const ColorImage& inside, ColorImage& picture) {
  const int width = inside.width() / kInset, height = inside.height() / kInset;
  const int margin = picture.height() / 45, border = std::max(picture.height() / 360, 1);
  const int left = std::max(picture.width() - margin - width, 0);
  fill_panel(picture, static_cast<float>(left - border), static_cast<float>(margin - border),
             static_cast<float>(width + 2 * border), static_cast<float>(height + 2 * border), 0,
             {255, 255, 255});
  for (int y = 0; y < height && margin + y < picture.height(); ++y) {
    Rgb* to = picture.row(margin + y) + left;
    for (int x = 0; x < width && left + x < picture.width(); ++x) {
      std::array<int, 3> sum{};
      for (int j = 0; j < kInset; ++j) {
        const Rgb* from = inside.row(kInset * y + j) + kInset * x;
        for (int i = 0; i < kInset; ++i) {
          sum[0] += from[i].r;
          sum[1] += from[i].g;
          sum[2] += from[i].b;
        }
      }
      constexpr int n = kInset * kInset;
      to[x] = {static_cast<std::uint8_t>((sum[0] + n / 2) / n),
               static_cast<std::uint8_t>((sum[1] + n / 2) / n),
               static_cast<std::uint8_t>((sum[2] + n / 2) / n)};
    }
  }
}

}  // namespace palpable
