#include "palpable/live/view/tiles.h"

#include "tests/support/test.h"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace palpable {
namespace {

TEST_CASE("tiles stand beside each other at half their size, more than three in two rows",
          "[view][tiles]") {
  const Rgb colors[] = {{200, 0, 0}, {0, 200, 0}, {0, 0, 200}, {200, 200, 0}, {0, 200, 200}};
  for (int count = 1; count <= 5; ++count) {
    INFO(count << " tiles");
    ColorImage sheet;
    for (int k = 0; k < count; ++k) {
      put_tile(ColorImage(322, 182, colors[k]), k, count, "name", sheet);
    }
    const int columns = count <= 3 ? count : count == 4 ? 2 : 3;
    CHECK(sheet.width() == columns * 160);
    CHECK(sheet.height() == (count <= 3 ? 1 : 2) * 90);
    for (int k = 0; k < count; ++k) {
      CHECK(sheet(160 * (k % columns) + 150, 90 * (k / columns) + 80) == colors[k]);
      // The name stands in its upper left corner.
      const auto is_letter = [](const Rgb& at) { return at.r > 120 && at.g > 120 && at.b > 120; };
      int letters = 0;
      for (int y = 0; y < 30; ++y) {
        const Rgb* row = sheet.row(90 * (k / columns) + y) + 160 * (k % columns);
        letters += static_cast<int>(std::count_if(row, row + 80, is_letter));
      }
      CHECK(letters > 10);
    }
    if (count == 5) CHECK(sheet(2 * 160 + 80, 90 + 45) == Rgb{});
  }
}

TEST_CASE(
    "the true mask is white where a body is not behind what is there, red where found otherwise",
    "[view][tiles]") {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  MaskImage visible(8, 2, std::uint8_t{0});
  DepthImage body(8, 2, kNone), real(4, 1, 0.5F);
  real(3, 0) = kNone;  // nothing is there
  const struct {
    float body;
    std::uint8_t found;
    Rgb shown;
  } columns[] = {{0.4F, 255, {255, 255, 255}}, {0.4F, 0, {220, 30, 30}},
                 {0.6F, 0, {0, 0, 0}},         {0.6F, 255, {220, 30, 30}},
                 {kNone, 0, {0, 0, 0}},        {kNone, 255, {220, 30, 30}},
                 {0.9F, 255, {255, 255, 255}}, {0.9F, 0, {220, 30, 30}}};
  for (int x = 0; x < 8; ++x) {
    for (int y = 0; y < 2; ++y) {
      body(x, y) = columns[x].body;
      visible(x, y) = columns[x].found;
    }
  }
  ColorImage picture;
  draw_true_mask(visible, body, real, picture);
  for (int x = 0; x < 8; ++x) CHECK(picture(x, 1) == columns[x].shown);
  draw_mask(visible, picture);
  for (int x = 0; x < 8; ++x) CHECK((picture(x, 0) == Rgb{255, 255, 255}) == (visible(x, 0) != 0));
}

}  // namespace
}  // namespace palpable
