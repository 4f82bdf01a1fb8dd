#include "palpable/live/live_page/half_size.h"

#include <cstddef>
#include <cstdint>

namespace palpable {

void halve(const ColorImage& picture, ColorImage& half) {
  PALPABLE_EXPECT(picture.width() >= 2 && picture.height() >= 2, "there are four pixels for one");
  half.resize(picture.width() / 2, picture.height() / 2);
  const auto mean = [](int a, int b, int c, int d) {
    return static_cast<std::uint8_t>((a + b + c + d + 2) / 4);
  };
  for (int y = 0; y < half.height(); ++y) {
    const Rgb* above = picture.row(2 * y);
    const Rgb* below = picture.row(2 * y + 1);
    Rgb* to = half.row(y);
    for (int x = 0; x < half.width(); ++x, above += 2, below += 2) {
      to[x] = {mean(above[0].r, above[1].r, below[0].r, below[1].r),
               mean(above[0].g, above[1].g, below[0].g, below[1].g),
               mean(above[0].b, above[1].b, below[0].b, below[1].b)};
    }
  }
}

}  // namespace palpable
