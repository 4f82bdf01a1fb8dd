#include "palpable/live/render/text.h"

#include "palpable/live/render/color_map.h"
#include "palpable/live/render/legend.h"
#include "palpable/live/render/picture_file.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <string>
#include <utility>
#include <vector>

using namespace palpable;

namespace {

ColorImage written(std::string_view text, float size) {
  ColorImage picture(300, 60);
  draw_text(picture, 5, 5, text, size, {255, 255, 255});
  return picture;
}

long ink_of(const ColorImage& picture) {
  long sum = 0;
  for (const Rgb& pixel : picture) sum += pixel.r;
  return sum;
}

}  // namespace

TEST_CASE("every letter of ASCII is drawn, each in its own shape", "[render]") {
  std::vector<ColorImage> seen;
  for (char c = '!'; c <= '~'; ++c) {
    INFO("letter " << c);
    const ColorImage picture = written(std::string(1, c), 28);
    CHECK(ink_of(picture) > 255 * 6);
    CHECK(std::find(seen.begin(), seen.end(), picture) == seen.end());
    seen.push_back(picture);
  }
  CHECK(ink_of(written(" ", 28)) == 0);
}

TEST_CASE("text stays within its measured size", "[render]") {
  for (const float size : {10.0f, 15.0f, 21.0f, 42.0f}) {
    INFO("size " << size);
    const std::string text = "Qgy|41 kPa";
    const TextSize extent = measure_text(text, size);
    const ColorImage picture = written(text, size);
    for (int y = 0; y < picture.height(); ++y) {
      for (int x = 0; x < picture.width(); ++x) {
        if (picture(x, y).r == 0) continue;
        CHECK((x >= 4 && static_cast<float>(x) <= 6 + extent.width));
        CHECK((y >= 4 && static_cast<float>(y) <= 6 + extent.height()));
      }
    }
  }
  CHECK(measure_text("mm", 20).width == Approx(2 * measure_text("m", 20).width));
  CHECK(measure_text("", 20).width == 0);
}

TEST_CASE("what the font lacks, or what is not UTF-8, becomes a question mark", "[render]") {
  const ColorImage question = written("?", 21);
  CHECK(written("\xe6\xbc\xa2", 21) == question);
  CHECK(written("\xff", 21) == question);
  CHECK(written("\xc2", 21) == question);  // cut off in the middle of a letter
  CHECK_FALSE(written("\xc2\xb0", 21) == question);
}

TEST_CASE("text and panels beyond the picture are cut off", "[render]") {
  ColorImage picture(20, 10);
  draw_text(picture, -30, -5, "wide text", 21, {255, 255, 255});
  draw_text(picture, 15, 5, "wide text", 21, {255, 255, 255});
  fill_panel(picture, -5, -5, 100, 100, 3, {9, 9, 9});
  CHECK(picture == ColorImage(20, 10, {9, 9, 9}));
}

TEST_CASE("ticks are round numbers within the scale", "[render]") {
  CHECK(round_ticks(10, 5) == std::vector<double>{0, 2, 4, 6, 8, 10});
  CHECK(round_ticks(23.7, 5) == std::vector<double>{0, 5, 10, 15, 20});
  CHECK(round_ticks(1, 5).size() == 6);
  CHECK(round_ticks(0.0007, 4).back() == Approx(0.0006));
  CHECK_THROWS_AS(round_ticks(0, 5), ContractViolation);
}

TEST_CASE("the legend marks the present largest value and says how far it may be off", "[render]") {
  const auto drawn = [](double present, double stated_error) {
    ColorImage picture(1280, 720, {128, 128, 128});
    draw_legend(picture, {.title = "von Mises",
                          .unit = "kPa",
                          .top = 10,
                          .present = present,
                          .stated_error = stated_error});
    return picture;
  };
  const ColorImage silent = drawn(std::numeric_limits<double>::quiet_NaN(), 0);
  const ColorImage low = drawn(2, 0), high = drawn(8, 0), over = drawn(50, 0);
  CHECK_FALSE(silent == low);
  // The mark extends beyond the bar on the left, where it is found by its white.
  const auto mark_row = [&](const ColorImage& picture) {
    for (int y = 0; y < picture.height(); ++y) {
      for (int x = picture.width() / 2; x + 20 < picture.width(); ++x) {
        int run = 0;
        while (x + run < picture.width() && picture(x + run, y) == Rgb{245, 246, 248}) ++run;
        if (run >= 20) return y;
      }
    }
    return -1;
  };
  CHECK(mark_row(silent) == -1);
  CHECK(mark_row(high) > 0);
  CHECK(mark_row(low) > mark_row(high) + 100);
  CHECK(mark_row(over) > 0);  // at the top, not above it
  CHECK(mark_row(over) < mark_row(high));
  // At rest there is neither a mark nor "max 0.0", and the panel stays where it is.
  CHECK(mark_row(drawn(0.02, 0)) == -1);
  CHECK(drawn(0.02, 0) == drawn(0, 0));
  // The panel does not move when the error appears or disappears.
  const ColorImage with_error = drawn(8, 0.14);
  CHECK_FALSE(with_error == high);
  CHECK(mark_row(with_error) == mark_row(high));
  // Above 100 % no figure is given.
  CHECK(drawn(8, 1.6) == drawn(8, 2.6));
  CHECK_FALSE(drawn(8, 1.0) == drawn(8, 1.6));
}

TEST_CASE("a legend of two signs has 0 in the middle, both ends' colours and both present values",
          "[render]") {
  const auto drawn = [](double least, double present, double stated_error) {
    ColorImage picture(1280, 720, {128, 128, 128});
    draw_legend(picture, {.title = "pressure",
                          .unit = "kPa",
                          .top = 10,
                          .two_sided = true,
                          .present = present,
                          .present_least = least,
                          .stated_error = stated_error,
                          .error_of = "stress"});
    return picture;
  };
  const auto rows_of = [](const ColorImage& picture, Rgb wanted) {
    std::vector<int> rows;
    for (int y = 0; y < picture.height(); ++y) {
      int run = 0, longest = 0;
      for (int x = picture.width() / 2; x < picture.width(); ++x) {
        const Rgb p = picture(x, y);
        const int apart = std::abs(p.r - wanted.r) + std::abs(p.g - wanted.g) +
                          std::abs(p.b - wanted.b);  // neighbouring rows are 3 apart
        run = apart <= 3 ? run + 1 : 0;
        longest = std::max(longest, run);
      }
      if (longest >= 12) rows.push_back(y);
    }
    return rows;
  };
  constexpr Rgb kInk{245, 246, 248};  // colour of the marks, which are wider than lines of letters
  const ColorImage picture = drawn(-4, 8, 0);
  const std::vector<int> marks = rows_of(picture, kInk);
  REQUIRE(marks.size() == 4);  // two marks of two rows
  // 10 kPa are half of the bar's 259 rows.
  CHECK(std::abs((marks[2] - marks[0]) - 0.5 * 259 * 12 / 10) <=
        palpable::test::tolerance(1.5, "px, rounding"));
  const std::vector<int> top = rows_of(picture, two_sided_color_of_share(0.99f));
  const std::vector<int> bottom = rows_of(picture, two_sided_color_of_share(-0.99f));
  REQUIRE_FALSE(top.empty());
  REQUIRE_FALSE(bottom.empty());
  CHECK(top.front() < marks.front());
  CHECK(bottom.back() > marks.back());
  // Values beyond the scale are marked at its ends.
  const std::vector<int> beyond = rows_of(drawn(-40, 80, 0), kInk);
  REQUIRE(beyond.size() == 4);
  CHECK(beyond[2] - beyond[0] == Approx(259).margin(2));
  // The panel does not move when the error appears or disappears, and it shows both values.
  CHECK(rows_of(drawn(-4, 8, 0.14), kInk) == marks);
  CHECK_FALSE(drawn(-4, 8, 0.14) == picture);
  CHECK_FALSE(drawn(-4.2, 8, 0) == drawn(-4.1, 8, 0));  // the same row of the bar, another number
}

TEST_CASE("a small legend of two signs has other numbers than 0", "[render]") {
  // If 0 were the only number, the ends of the scale would not be known.
  const auto drawn = [](double top) {
    ColorImage picture(320, 180, {128, 128, 128});
    draw_legend(picture, {.title = "pressure",
                          .unit = "kPa",
                          .top = top,
                          .two_sided = true,
                          .scale = legend_scale(180)});
    return picture;
  };
  for (const double top : {1.3, 4.1, 9.9, 16.3}) {
    INFO("top " << top);
    CHECK_FALSE(drawn(top) == drawn(0.95 * top));
  }
}

TEST_CASE("legends are the same as in the stored picture, which was checked by eye",
          "[render][pixels]") {
  // Side by side: stress over rubber with its error, a pressure of two signs, and the legend of a
  // small picture.
  const Rgb rubber{218, 205, 182};
  const Legend stress{.title = "von Mises",
                      .unit = "kPa",
                      .top = 16.3,
                      .material = rubber,
                      .opaque = kOpaqueShare,
                      .present = 12.3,
                      .stated_error = 0.034};
  const Legend pressure{.title = "pressure",
                        .unit = "kPa",
                        .top = 16.3,
                        .two_sided = true,
                        .material = rubber,
                        .opaque = kOpaqueShare,
                        .present = 9.5,
                        .present_least = -3.8,
                        .stated_error = 0.2,
                        .error_of = "stress"};
  Legend small = stress;
  small.scale = legend_scale(180);
  constexpr int kWide = 150, kHigh = 440;
  ColorImage now(3 * kWide, kHigh, {128, 128, 128});
  const auto put = [&](const Legend& legend, int rows, int place) {
    ColorImage picture(rows * 16 / 9, rows, {128, 128, 128});
    draw_legend(picture, legend);
    const int high = std::min(rows, kHigh);
    for (int y = 0; y < high; ++y) {
      for (int x = 0; x < kWide; ++x) {
        now(place * kWide + x, y) = picture(picture.width() - kWide + x, (rows - high) / 2 + y);
      }
    }
  };
  put(stress, 720, 0);
  put(pressure, 720, 1);
  put(small, 180, 2);
  const ColorImage then = value_or_throw(read_png("tests/data/legend.png"));
  REQUIRE((then.width() == now.width() && then.height() == now.height()));
  int apart = 0;
  for (std::size_t i = 0; i < now.size(); ++i) {
    const Rgb a = now.data()[i], b = then.data()[i];
    apart = std::max({apart, std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
  }
  if (apart > 2) write_png("/tmp/palpable_legend.png", now);
  INFO("it is kept as /tmp/palpable_legend.png");
  // Legends are drawn on the CPU with the built-in font, so that only the last bits of single
  // precision may differ between compilers.
  CHECK(apart <= palpable::test::tolerance(2, "levels: the colour's and the panel's rounding"));
}

TEST_CASE("the legend shows the colours from bottom to top and writes beside them", "[render]") {
  for (const int height : {360, 720, 1080}) {
    INFO("rows " << height);
    ColorImage picture(height * 16 / 9, height, {128, 128, 128});
    draw_legend(picture, {.title = "von Mises",
                          .unit = "kPa",
                          .top = 12.5,
                          .scale = static_cast<float>(height) / 720.0f});
    const auto rows_of = [&](float share) {
      const Rgb wanted = color_of_share(share);
      const auto far = [](int a, int b) { return std::abs(a - b); };
      int last = -1;
      for (int y = 0; y < picture.height(); ++y) {
        for (int x = picture.width() / 2; x < picture.width(); ++x) {
          const Rgb p = picture(x, y);
          if (far(p.r, wanted.r) + far(p.g, wanted.g) + far(p.b, wanted.b) <= 6) last = y;
        }
      }
      return last;
    };
    const int low = rows_of(0.02f), middle = rows_of(0.5f), high = rows_of(0.98f);
    CHECK(high >= 0);
    CHECK(high < middle);
    CHECK(middle < low);
    // Light letters on the dark panel.
    const auto light = std::count_if(picture.begin(), picture.end(),
                                     [](Rgb p) { return p.r > 190 && p.g > 190 && p.b > 190; });
    CHECK(light > height / 6);
  }
}

namespace {

// The share of the picture that differs from the plain one.
double covered(const ColorImage& picture, Rgb plain) {
  const auto same = std::count(picture.begin(), picture.end(), plain);
  return 1 - static_cast<double>(same) / static_cast<double>(picture.size());
}

}  // namespace

TEST_CASE("legend and caption leave the picture free, whatever its size", "[render]") {
  constexpr Rgb kPlain{128, 128, 128};
  struct Case {
    int width, height;
    double most;  // share
  };
  for (const auto& [width, height, most] :
       {Case{160, 120, 0.12}, Case{320, 240, 0.05}, Case{640, 480, 0.07}, Case{1280, 720, 0.05}}) {
    INFO(width << " x " << height);
    ColorImage picture(width, height, kPlain);
    draw_legend(picture, {.title = "von Mises",
                          .unit = "kPa",
                          .top = 16.3,
                          .present = 8,
                          .stated_error = 0.14,
                          .scale = legend_scale(height)});
    CHECK(covered(picture, kPlain) < most);
    CHECK(covered(picture, kPlain) > most / 4);  // large enough to be read
    ColorImage captioned(width, height, kPlain);
    const std::vector<std::string> lines{"2.27 s   13 touches   1.0 mm   6.22 N"};
    draw_caption(captioned, lines, legend_scale(height));
    CHECK(covered(captioned, kPlain) < (width < 320 ? 0.25 : 0.06));
  }
}

TEST_CASE("a text wider than the picture goes on below and loses nothing", "[render]") {
  constexpr Rgb kPlain{128, 128, 128};
  const auto extent_of = [&](const ColorImage& picture) {
    int right = -1, rows = 0;
    for (int y = 0; y < picture.height(); ++y) {
      bool any = false;
      for (int x = 0; x < picture.width(); ++x) {
        if (picture(x, y) == kPlain) continue;
        any = true;
        right = std::max(right, x);
      }
      rows += any ? 1 : 0;
    }
    return std::pair(right, rows);
  };
  const std::vector<std::string> wide{
      "2.27 s   13 touches   1.0 mm   6.22 N   model error \u00b112 %, stress \u00b134 %"};
  ColorImage one(1280, 240, kPlain), several(320, 240, kPlain);
  draw_caption(one, wide, 0.75f);
  draw_caption(several, wide, 0.75f);
  CHECK(extent_of(several).first < 320 - 2);  // its panel ends inside
  CHECK(extent_of(several).second > extent_of(one).second + 8);
  const auto ink = [](const ColorImage& picture) {
    return std::count_if(picture.begin(), picture.end(), [](Rgb p) { return p.r > 180; });
  };
  CHECK(ink(several) > ink(one) * 9 / 10);
  ColorImage warned(320, 240, kPlain);
  draw_warning(warned, "What presses is not seen at present: its last place is held", 0.75f);
  CHECK(extent_of(warned).first < 320 - 2);
  // A word that is wider than the picture is drawn as far as it fits.
  draw_caption(warned, std::vector<std::string>{std::string(200, 'm'), ""}, 0.75f);
}
