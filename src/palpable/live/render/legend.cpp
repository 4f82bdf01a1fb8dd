#include "palpable/live/render/legend.h"

#include "palpable/common/base/contract.h"
#include "palpable/live/render/color_map.h"
#include "palpable/live/render/text.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace palpable {
namespace {

constexpr Rgb kPanel{18, 22, 28};
constexpr Rgb kInk{245, 246, 248};
constexpr Rgb kQuietInk{200, 205, 212};
constexpr float kPanelOpacity = 0.62f;

double tick_step(double top, int wanted) {
  const double raw = top / std::max(wanted, 1);
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= raw * (1.0 - 1e-9)) return factor * power;
  }
  return 10.0 * power;
}

/// Writes a tick's number with as many decimals as its step needs, into the caller's memory.
std::string_view print_tick(double value, double step, std::array<char, 32>& text) {
  const int digits = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
  const auto end = fmt::format_to_n(text.data(), text.size(), "{:.{}f}", value, digits);
  return {text.data(), std::min(end.size, text.size())};
}

// A line of text of limited length, without heap memory, since a legend is drawn for every frame.
class ShortText {
 public:
  template <class... Values>
  void print(fmt::format_string<Values...> format, Values&&... values) {
    const auto end =
        fmt::format_to_n(text_.data(), text_.size(), format, std::forward<Values>(values)...);
    size_ = std::min(end.size, text_.size());
  }
  [[nodiscard]] std::string_view view() const { return {text_.data(), size_}; }

 private:
  std::array<char, 32> text_{};
  std::size_t size_ = 0;
};

// Written above the error, which is that of the reduced model and leaves out the camera's.
constexpr std::string_view kErrorTitle = "model error";

// The lines below the bar.
struct PresentText {
  explicit PresentText(const Legend& legend) : shown(!std::isnan(legend.present)) {
    // At rest there would be "max 0.0" and a mark at 0, which say nothing.
    const bool at_rest = is_written_as_zero(legend.present) &&
                         (!legend.two_sided || is_written_as_zero(legend.present_least));
    if (!shown || at_rest) return;
    print_value("max", legend.present, largest);
    if (legend.two_sided) print_value("min", legend.present_least, least);
    if (!(legend.stated_error > 0)) return;
    // One significant digit: the error itself is not known better.
    const double percent = 100 * legend.stated_error;
    const std::string_view space = legend.error_of.empty() ? "" : " ";
    if (percent > 100) {
      error.print("{}{}> 100 %", legend.error_of, space);
    } else {
      error.print("{}{}\u00b1 {:.{}f} %", legend.error_of, space, percent, percent < 1 ? 1 : 0);
    }
  }

  bool shown;
  ShortText largest, least, error;

 private:
  static bool is_written_as_zero(double value) { return std::abs(value) < 0.05; }  // one decimal

  static void print_value(std::string_view name, double value, ShortText& text) {
    const int digits = std::abs(value) < 10 ? 1 : 0;
    // A value that rounds to 0 is written without a sign.
    text.print("{} {:.{}f}", name, is_written_as_zero(value) ? 0.0 : value, digits);
  }
};

// The numbers beside the bar: multiples of `step`, from the lower end to the upper one.
struct Ticks {
  Ticks(const Legend& legend, int wanted)
      : step(step_of(legend, wanted)),
        last(static_cast<int>(std::floor(legend.top * (1.0 + 1e-9) / step))),
        first(legend.two_sided ? -last : 0) {}
  double step;
  int last, first;

 private:
  static double step_of(const Legend& legend, int wanted) {
    if (!legend.two_sided) return tick_step(legend.top, wanted);
    const double step = tick_step(2 * legend.top, wanted);
    // If 0 were the only number, the scale could not be read. Consecutive steps differ by a factor
    // of at most 2.5.
    return step <= legend.top ? step : tick_step(legend.top / 2.5, 1);
  }
};

// The height of a number on the bar, 0 .. 1.
float height_of(double value, const Legend& legend) {
  const double share = value / legend.top;
  return static_cast<float>(std::clamp(legend.two_sided ? 0.5 + 0.5 * share : share, 0.0, 1.0));
}

Rgb color_at_height(float height, const Legend& legend) {
  return legend.two_sided
             ? two_sided_color_of_share(2.0f * height - 1.0f, legend.material, legend.opaque)
             : color_of_share(height, legend.material, legend.opaque, legend.colors);
}

// Lengths of a legend in px, and the number of its ticks.
struct LegendLayout {
  explicit LegendLayout(const ColorImage& picture, float the_scale)
      : small(picture.height() < kSmallPicture),
        s(the_scale),
        pad((small ? 4.0f : 12.0f) * s),
        bar_width((small ? 8.0f : 16.0f) * s),
        bar_height(std::round((small ? 0.30f : 0.36f) * static_cast<float>(picture.height()))),
        edge((small ? 5.0f : 16.0f) * s),
        corner((small ? 4.0f : 8.0f) * s),
        above_bar((small ? 6.0f : 10.0f) * s),
        below_bar((small ? 5.0f : 4.0f) * s),
        ticks(small ? 2 : 5) {}
  bool small;
  float s;                                         // scale of the text
  float letters = 15.0f * s, numbers = 13.0f * s;  // sizes of the text
  float pad;
  float bar_width, bar_height;
  float edge;  // from the picture's right edge
  float corner, above_bar, below_bar;
  int ticks;
  float bar_x = 0, bar_y = 0;  // of the bar's upper left corner in the picture
};

float inner_width(const Legend& legend, const LegendLayout& layout, const Ticks& ticks,
                  bool writes_present) {
  const float numbers = layout.numbers;
  std::array<char, 32> text;
  float number_width = 0;
  for (int i = ticks.first; i <= ticks.last; ++i) {
    const std::string_view number = print_tick(i * ticks.step, ticks.step, text);
    number_width = std::max(number_width, measure_text(number, numbers).width);
  }
  const float title = layout.small ? 0.0f : measure_text(legend.title, layout.letters).width;
  const float inner = std::max({title, measure_text(legend.unit, numbers).width,
                                layout.bar_width + 10.0f * layout.s + number_width});
  if (!writes_present) return inner;
  // As wide as its widest possible numbers, so that the panel does not move while they change.
  const float error = legend.error_of.empty() ? 0.0f
                                              : measure_text(legend.error_of, numbers).width +
                                                    measure_text(" > 100 %", numbers).width;
  return std::max({inner, measure_text("max 000.0", numbers).width,
                   measure_text(kErrorTitle, numbers).width, error});
}

float y_on_bar(double value, const Legend& legend, const LegendLayout& layout) {
  return layout.bar_y + layout.bar_height * (1.0f - height_of(value, legend));
}

// The bar with its ticks and their numbers.
void draw_bar(ColorImage& picture, const Legend& legend, const LegendLayout& layout,
              const Ticks& ticks) {
  const float s = layout.s, right = layout.bar_x + layout.bar_width;
  for (int row = 0; row < static_cast<int>(layout.bar_height); ++row) {
    const float share = 1.0f - (static_cast<float>(row) + 0.5f) / layout.bar_height;
    fill_panel(picture, layout.bar_x, layout.bar_y + static_cast<float>(row), layout.bar_width,
               1.0f, 0.0f, color_at_height(share, legend));
  }
  std::array<char, 32> text;
  for (int i = ticks.first; i <= ticks.last; ++i) {
    const float at = y_on_bar(i * ticks.step, legend, layout);
    fill_panel(picture, right, std::round(at - 0.5f), 5.0f * s, std::max(1.0f, std::round(s)), 0.0f,
               kInk);
    const std::string_view number = print_tick(i * ticks.step, ticks.step, text);
    const TextSize extent = measure_text(number, layout.numbers);
    draw_text(picture, right + 9.0f * s, at - 0.5f * extent.height(), number, layout.numbers, kInk);
  }
}

// The marks of the present values on the bar.
void draw_marks(ColorImage& picture, const Legend& legend, const LegendLayout& layout) {
  const float s = layout.s;
  const auto mark = [&](double value) {
    fill_panel(picture, layout.bar_x - 4.0f * s, std::round(y_on_bar(value, legend, layout) - s),
               layout.bar_width + 8.0f * s, std::max(2.0f, std::round(2.0f * s)), 0.0f, kInk);
  };
  mark(legend.present);
  if (legend.two_sided) mark(legend.present_least);
}

// Breaks a text into lines of at most `room` px and calls draw(line) for each. A line is broken at
// three spaces if there are any, else at the last space that fits; a single word is never broken.
// Allocates nothing, since captions are drawn for every frame.
// In a very narrow picture nothing is broken: a column of words would hide all of it.
template <class Draw>
void for_each_line_within(std::string_view text, float size, float room, const Draw& draw) {
  constexpr float kNarrowest = 120;  // px
  const auto fits = [&](std::string_view part) {
    return room < kNarrowest || measure_text(part, size).width <= room;
  };
  const auto last_break = [&](std::string_view gap) {
    std::size_t best = std::string_view::npos;
    for (auto at = text.find(gap); at != std::string_view::npos;
         at = text.find(gap, at + gap.size())) {
      if (at > 0 && fits(text.substr(0, at))) best = at;
    }
    return best;
  };
  while (!fits(text)) {
    auto at = last_break("   ");
    if (at == std::string_view::npos) at = last_break(" ");
    if (at == std::string_view::npos) break;
    draw(text.substr(0, at));
    text.remove_prefix(std::min(text.find_first_not_of(' ', at), text.size()));
  }
  draw(text);
}

}  // namespace

std::vector<double> round_ticks(double top, int wanted) {
  PALPABLE_EXPECT(top > 0.0 && std::isfinite(top), "the scale has a length");
  const double step = tick_step(top, wanted);
  std::vector<double> ticks;
  for (int i = 0; i * step <= top * (1.0 + 1e-9); ++i) ticks.push_back(i * step);
  return ticks;
}

void draw_legend(ColorImage& picture, const Legend& legend) {
  PALPABLE_EXPECT(legend.top > 0.0 && std::isfinite(legend.top), "the scale has a length");
  const float s = legend.scale;
  LegendLayout layout(picture, s);
  const float pad = layout.pad, numbers = layout.numbers;
  const Ticks ticks(legend, layout.ticks);
  const PresentText present(legend);
  const bool writes_present = present.shown && !layout.small;
  const TextSize title = layout.small ? TextSize{} : measure_text(legend.title, layout.letters);
  const TextSize unit = measure_text(legend.unit, numbers);
  const float line_height = measure_text("0", numbers).height();
  const float width = inner_width(legend, layout, ticks, writes_present) + 2.0f * pad;
  // Room for all lines, so that the panel does not move when the error appears or disappears.
  const float lines = legend.two_sided ? 4.0f : 3.0f;
  const float below = writes_present ? 8.0f * s + lines * line_height : 0.0f;
  const float height = 2.0f * pad + title.height() + unit.height() + layout.above_bar +
                       layout.bar_height + layout.below_bar + below;
  const float x = static_cast<float>(picture.width()) - width - layout.edge;
  const float y = 0.5f * (static_cast<float>(picture.height()) - height);
  fill_panel(picture, x, y, width, height, layout.corner, kPanel, kPanelOpacity);
  if (!layout.small) draw_text(picture, x + pad, y + pad, legend.title, layout.letters, kInk);
  draw_text(picture, x + pad, y + pad + title.height(), legend.unit, numbers, kQuietInk);

  layout.bar_x = std::round(x + pad);
  layout.bar_y = std::round(y + pad + title.height() + unit.height() + layout.above_bar);
  draw_bar(picture, legend, layout, ticks);
  if (!present.largest.view().empty()) draw_marks(picture, legend, layout);
  if (!writes_present) return;
  float text_y = layout.bar_y + layout.bar_height + 12.0f * s;
  const auto write = [&](std::string_view line, Rgb ink) {
    draw_text(picture, x + pad, text_y, line, numbers, ink);
    text_y += line_height;
  };
  write(present.largest.view(), kInk);
  if (legend.two_sided) write(present.least.view(), kInk);
  if (present.error.view().empty()) return;
  write(kErrorTitle, kQuietInk);
  write(present.error.view(), kQuietInk);
}

void draw_label(ColorImage& picture, float x, float y, std::string_view text, float size) {
  const TextSize extent = measure_text(text, size);
  const float pad = 0.3f * size;
  fill_panel(picture, x - pad, y - 0.5f * pad, extent.width + 2.0f * pad, extent.height() + pad,
             pad, kPanel, kPanelOpacity);
  draw_text(picture, x, y, text, size, kInk);
}

void draw_warning(ColorImage& picture, std::string_view text, float scale) {
  constexpr Rgb kRed{178, 22, 22};
  const auto width = static_cast<float>(picture.width());
  float size = 24.0f * scale;
  const float pad = 12.0f * scale;
  const float room = width - 4.0f * pad;
  const float needed = measure_text(text, size).width;
  if (needed > room) size *= std::max(room, 1.0f) / needed;
  float widest = 0;
  float height = 0;
  for_each_line_within(text, size, room, [&](std::string_view line) {
    const TextSize extent = measure_text(line, size);
    widest = std::max(widest, extent.width);
    height += extent.height();
  });
  fill_panel(picture, 0.5f * (width - widest) - pad, pad, widest + 2.0f * pad, height + pad,
             8.0f * scale, kRed, 0.88f);
  float y = 1.5f * pad;
  for_each_line_within(text, size, room, [&](std::string_view line) {
    const TextSize extent = measure_text(line, size);
    draw_text(picture, 0.5f * (width - extent.width), y, line, size, {255, 255, 255});
    y += extent.height();
  });
}

float legend_scale(int rows) { return std::max(static_cast<float>(rows) / 720.0f, 0.75f); }

void draw_caption(ColorImage& picture, std::span<const std::string> lines, float scale) {
  const bool small = picture.height() < kSmallPicture;
  const float size = 15.0f * scale, pad = (small ? 4.0f : 10.0f) * scale, gap = 3.0f * scale;
  const float edge = (small ? 5.0f : 16.0f) * scale;
  const float room = static_cast<float>(picture.width()) - 2.0f * (edge + pad);
  float width = 0, height = 0;
  for (const std::string& line : lines) {
    for_each_line_within(line, size, room, [&](std::string_view part) {
      const TextSize extent = measure_text(part, size);
      width = std::max(width, extent.width);
      height += extent.height() + gap;
    });
  }
  if (width == 0) return;
  float y = static_cast<float>(picture.height()) - edge - height - 2.0f * pad + gap;
  fill_panel(picture, edge, y, width + 2.0f * pad, height + 2.0f * pad - gap, 8.0f * scale, kPanel,
             kPanelOpacity);
  y += pad;
  for (const std::string& line : lines) {
    for_each_line_within(line, size, room, [&](std::string_view part) {
      draw_text(picture, edge + pad, y, part, size, kInk);
      y += measure_text(part, size).height() + gap;
    });
  }
}

}  // namespace palpable
