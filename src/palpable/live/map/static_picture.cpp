#include "palpable/live/map/static_picture.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <hwy/base.h>

namespace palpable {
namespace {

constexpr int kPixels = 16;   // pixels of a tile
constexpr int kSteps = 4096;  // bins of the histograms
// Limits of a tile's sum of grey levels. Below and above, the tile is nearly black or clipped, and
// its Y / P does not measure the gain.
constexpr int kDarkest = 4 * kPixels, kBrightest = 240 * kPixels;
constexpr int kGainEvery = 2;  // every 2nd tile of every 2nd row: enough for a median
// Fewest static tiles from which gain and noise are measured; with fewer, the values of the frame
// before are kept.
constexpr int kFewestTiles = 50;
// Increment of sure_ in a frame in which the mask has the tile at rest; otherwise it is 1. So a
// hand at rest that is still masked as moving must look the same for five times as long before it
// is taken for the scene.
constexpr int kQuietCounts = 5;
constexpr int kFollowEvery = 4;  // P follows Y in every 4th frame
constexpr int kColorEvery = 32;  // frames between updates of the colours, which hardly change

// 1.06 k for k = 4: a_4(n) = m (1 + kFourOfD / sqrt(n)) + 1/2 (static_picture.h). The bound for a
// changed tile, a_8, has twice this value.
constexpr double kFourOfD = 4.24;
constexpr int kLightShare = 32;     // 1/32 of P: light that a hand may reflect or block
constexpr int kDarkestShadow = 40;  // % of the light; darker tiles are not in shadow

// Allowed difference of a shadow's hue: min(kSunAndSky (1 - L) / L, kHue).
constexpr double kSunAndSky = 0.14, kHue = 0.11;
// Standard deviation of a tile's mean colour, in units of m: it is the mean of eight pixels of the
// full image, whose noise is twice that of the half image, and s = 1.25 m.
constexpr double kOfColor = 2 * 1.25 / 2.83;
constexpr int kLargestSquare = 2;  // tiles from the middle tile to each side
// Largest difference between the mean Y - g P of two tiles of one surface, in units of m: three
// standard deviations.
constexpr double kAlike = 1.9;

void halve_rows(const std::uint8_t* a, const std::uint8_t* b, std::uint8_t* half, int width) {
  for (int x = 0; x < width; ++x) {
    const int sum = a[2 * x] + a[2 * x + 1] + b[2 * x] + b[2 * x + 1];
    half[x] = static_cast<std::uint8_t>((sum + 2) >> 2);
  }
}

// Adds a row of pixels to the sums of their columns.
void add_row(const std::uint8_t* row, std::uint16_t* columns, int width) {
  for (int x = 0; x < width; ++x) columns[x] = static_cast<std::uint16_t>(columns[x] + row[x]);
}

// Computes the sum of each tile from the sums of its four columns.
void sums_of(const std::uint16_t* columns, std::uint16_t* sums, int tiles) {
  for (int i = 0; i < tiles; ++i) {
    const std::uint16_t* c = columns + static_cast<std::ptrdiff_t>(kTile) * i;
    sums[i] = static_cast<std::uint16_t>(c[0] + c[1] + c[2] + c[3]);
  }
}

// A row of pixels times factor / 512, at most 255.
void scale_row(const std::uint8_t* row, std::uint16_t factor, std::uint8_t* scaled, int width) {
  for (int x = 0; x < width; ++x) {
    const auto wide = static_cast<std::uint32_t>(row[x]) << 7;
    const auto value = static_cast<std::uint16_t>(wide * factor >> 16);
    scaled[x] = static_cast<std::uint8_t>(std::min<std::uint16_t>(value, 255));
  }
}

// These take values: with references (std::min) the compiler emits branches and does not vectorise.
std::uint8_t lesser(std::uint8_t a, std::uint8_t b) { return a < b ? a : b; }
std::uint8_t larger(std::uint8_t a, std::uint8_t b) { return a > b ? a : b; }

// The least and the largest of each value and its two neighbours.
void span_of_three(const std::uint8_t* p, std::uint8_t* HWY_RESTRICT least,
                   std::uint8_t* HWY_RESTRICT largest, int width) {
  least[0] = largest[0] = p[0];
  least[width - 1] = largest[width - 1] = p[width - 1];
  for (int x = 1; x < width - 1; ++x) {
    least[x] = lesser(lesser(p[x - 1], p[x]), p[x + 1]);
    largest[x] = larger(larger(p[x - 1], p[x]), p[x + 1]);
  }
}

// Finds the value nearest to `seen` in the range between the least and the largest value of three
// rows, and its distance from `seen`.
void nearest_within(const std::array<const std::uint8_t*, 3>& least,
                    const std::array<const std::uint8_t*, 3>& largest, const std::uint8_t* seen,
                    std::uint8_t* HWY_RESTRICT nearest, std::uint8_t* HWY_RESTRICT difference,
                    int width) {
  const auto [l0, l1, l2] = least;
  const auto [h0, h1, h2] = largest;
  for (int x = 0; x < width; ++x) {
    const std::uint8_t low = lesser(lesser(l0[x], l1[x]), l2[x]);
    const std::uint8_t high = larger(larger(h0[x], h1[x]), h2[x]);
    const std::uint8_t within = lesser(larger(seen[x], low), high);
    nearest[x] = within;
    difference[x] = static_cast<std::uint8_t>(larger(seen[x], within) - lesser(seen[x], within));
  }
}

// The bin that holds the median of a histogram with `count` entries.
int median_of(const std::vector<int>& histogram, int count) {
  int below = 0, at = 0;
  while (at < kSteps - 1 && 2 * (below + histogram[at]) < count) below += histogram[at++];
  return at;
}

}  // namespace

StaticPicture::StaticPicture(const StaticPictureSettings& settings)
    : settings_(settings),
      trust_(kQuietCounts * settings.frames_to_trust),
      histogram_(kSteps),
      gain_(kUnit) {
  PALPABLE_EXPECT(settings.frames_to_trust >= 1 && settings.frames_to_trust <= 50 &&
                      settings.frames_to_renew >= 1 && settings.frames_to_settle >= 1 &&
                      settings.frames_to_settle < 60000,
                  "frames are counted from 1");
}

void StaticPicture::forget() {
  ++frame_;  // else a camera that moves from the first frame on would be starting() for ever
  std::fill(sure_.begin(), sure_.end(), std::uint8_t{0});
  if (!starting()) std::fill(anew_.begin(), anew_.end(), std::uint8_t{1});
}

void StaticPicture::resize(int width, int height, const Image<std::uint8_t>& tiles) {
  if (now_.width() == width && now_.height() == height) return;
  now_ = picture_ = difference_ = GrayImage(width, height);
  least_ = largest_ = GrayImage(width, 3);
  look_ = sure_ = anew_ = colored_ = tested_ = Image<std::uint8_t>(tiles.width(), tiles.height());
  queue_.reserve(look_.size());
  sum_now_ = sum_then_ = sum_difference_ = strange_ =
      Image<std::uint16_t>(tiles.width(), tiles.height());
  colors_ = colors_now_ = Image<TileColor>(tiles.width(), tiles.height());
  columns_.resize(width);
  columns_of_difference_.resize(columns_.size());
  scaled_.resize(columns_.size());
  follows_.resize(columns_.size());
  tiles_ = width / kTile;
  rows_ = height / kTile;
}

bool StaticPicture::compare(const GrayImage& luma, const ColorImage& color, int width, int height,
                            const Image<std::uint8_t>& is_static) {
  if (!halve(luma, color, width, height, is_static)) return false;
  find_gain(is_static);
  find_differences();
  decide_looks(color, is_static, nullptr);
  return true;
}

bool StaticPicture::compare(const GrayImage& luma, const ColorImage& color, int width, int height,
                            const Image<std::uint8_t>& is_static, const PictureView& view) {
  if (!halve(luma, color, width, height, is_static)) return false;
  use_view(view);
  gain_ = view_gain_;
  find_gain(is_static);
  view_gain_ = gain_;
  replace_by_nearest(view);
  decide_looks(color, is_static, &view);
  return true;
}

// Finds all looks once the differences are known.
void StaticPicture::decide_looks(const ColorImage& color, const Image<std::uint8_t>& is_static,
                                 const PictureView* view) {
  find_noise(is_static);
  find_looks(color, is_static, view);
  spread_changes(color, is_static);
}

// Scales the frame's luma to the depth's size and sums it over tiles. False if the sizes do not
// fit.
bool StaticPicture::halve(const GrayImage& luma, const ColorImage& color, int width, int height,
                          const Image<std::uint8_t>& tiles) {
  const auto factor_of = [&](const auto& image) {
    const int factor = width > 0 ? image.width() / width : 0;
    return factor >= 1 && factor <= 2 && image.height() / factor == height ? factor : 0;
  };
  const int factor = factor_of(luma);
  factor_ = factor_of(color);
  if (factor == 0 || factor_ == 0) return false;
  resize(width, height, tiles);
  for (int j = 0; j < rows_; ++j) {
    std::fill(columns_.begin(), columns_.end(), std::uint16_t{0});
    for (int y = kTile * j; y < kTile * j + kTile; ++y) {
      if (factor == 1) {
        std::copy_n(luma.row(y), width, now_.row(y));
      } else {
        halve_rows(luma.row(2 * y), luma.row(2 * y + 1), now_.row(y), width);
      }
      add_row(now_.row(y), columns_.data(), width);
    }
    sums_of(columns_.data(), sum_now_.row(j), tiles_);
  }
  return true;
}

// Copies from a view the sums that find_gain() needs, the tiles' colours, and which are known.
void StaticPicture::use_view(const PictureView& view) {
  const int width = now_.width();
  for (int j = 0; j < rows_; j += kGainEvery) {
    std::fill(columns_.begin(), columns_.end(), std::uint16_t{0});
    for (int y = kTile * j; y < kTile * j + kTile; ++y) {
      add_row(view.luma.row(y), columns_.data(), width);
    }
    sums_of(columns_.data(), sum_then_.row(j), tiles_);
  }
  const auto trust = static_cast<std::uint8_t>(trust_);
  for (int j = 0; j < rows_; ++j) {
    std::copy_n(view.colors.row(j), tiles_, colors_.row(j));
    const std::uint8_t* known = view.known.row(j);
    std::transform(known, known + tiles_, sure_.row(j), [trust](std::uint8_t is_known) {
      return is_known != 0 ? trust : std::uint8_t{0};
    });
  }
}

// Clamps each pixel's luma in the kept picture of the scene to the range that the 3 x 3 pixels
// around it have in the view, after the view was multiplied by the gain. The gain is 1 afterwards,
// because it has been applied.
void StaticPicture::replace_by_nearest(const PictureView& view) {
  const int width = now_.width(), height = kTile * rows_;
  // Only three rows are kept at a time, which fit into the L1 cache.
  const auto find_span = [&](int y) {
    const std::uint8_t* p = view.luma.row(y);
    if (gain_ != kUnit) {
      scale_row(p, static_cast<std::uint16_t>(gain_), scaled_.data(), width);
      p = scaled_.data();
    }
    span_of_three(p, least_.row(y % 3), largest_.row(y % 3), width);
  };
  find_span(0);
  for (int j = 0; j < rows_; ++j) {
    std::fill(columns_.begin(), columns_.end(), std::uint16_t{0});
    std::fill(columns_of_difference_.begin(), columns_of_difference_.end(), std::uint16_t{0});
    for (int y = kTile * j; y < kTile * j + kTile; ++y) {
      const int above = std::max(y - 1, 0), below = std::min(y + 1, height - 1);
      if (below > y) find_span(below);
      nearest_within({least_.row(above % 3), least_.row(y % 3), least_.row(below % 3)},
                     {largest_.row(above % 3), largest_.row(y % 3), largest_.row(below % 3)},
                     now_.row(y), picture_.row(y), difference_.row(y), width);
      add_row(picture_.row(y), columns_.data(), width);
      add_row(difference_.row(y), columns_of_difference_.data(), width);
    }
    sums_of(columns_.data(), sum_then_.row(j), tiles_);
    sums_of(columns_of_difference_.data(), sum_difference_.row(j), tiles_);
  }
  gain_ = kUnit;
}

void StaticPicture::find_gain(const Image<std::uint8_t>& is_static) {
  std::fill(histogram_.begin(), histogram_.end(), 0);
  int count = 0;
  for (int j = 0; j < rows_; j += kGainEvery) {
    for (int i = 0; i < tiles_; i += kGainEvery) {
      const int then = sum_then_(i, j), now = sum_now_(i, j);
      if (is_static(i, j) == 0 || sure_(i, j) < trust_ || then < kDarkest || then > kBrightest ||
          now > kBrightest) {
        continue;
      }
      ++histogram_[std::min(kUnit * now / then, kSteps - 1)];
      ++count;
    }
  }
  if (count >= kFewestTiles) gain_ = std::max(median_of(histogram_, count), 1);
  if (std::abs(gain_ - kUnit) <= 2) gain_ = kUnit;  // a change of 0.4 % is ignored
}

void StaticPicture::find_differences() {
  const int width = now_.width();
  for (int j = 0; j < rows_; ++j) {
    std::fill(columns_.begin(), columns_.end(), std::uint16_t{0});
    for (int y = kTile * j; y < kTile * j + kTile; ++y) {
      const std::uint8_t *a = now_.row(y), *b = picture_.row(y);
      std::uint8_t* d = difference_.row(y);
      if (gain_ != kUnit) {
        scale_row(b, static_cast<std::uint16_t>(gain_), scaled_.data(), width);
        b = scaled_.data();
      }
      for (int x = 0; x < width; ++x) {
        d[x] = static_cast<std::uint8_t>(std::max(a[x], b[x]) - std::min(a[x], b[x]));
      }
      add_row(d, columns_.data(), width);
    }
    sums_of(columns_.data(), sum_difference_.row(j), tiles_);
  }
}

void StaticPicture::find_noise(const Image<std::uint8_t>& is_static) {
  std::fill(histogram_.begin(), histogram_.end(), 0);
  int count = 0;
  for (int j = 0; j < rows_; ++j) {
    for (int i = 0; i < tiles_; ++i) {
      if (is_static(i, j) == 0 || sure_(i, j) < trust_) continue;
      ++histogram_[std::min<std::size_t>(sum_difference_(i, j), kSteps - 1)];
      ++count;
    }
  }
  if (count >= kFewestTiles) noise_ = static_cast<double>(median_of(histogram_, count)) / kPixels;
}

void StaticPicture::find_looks(const ColorImage& color, const Image<std::uint8_t>& is_static,
                               const PictureView* view) {
  const bool measured = noise_ >= 0;
  const double m = measured ? noise_ : 0;
  const auto sum_of = [](int n, double mean) { return static_cast<int>(n * mean); };
  const int same = sum_of(kPixels, m * (1 + kFourOfD / 4) + 0.5);
  const int changed = sum_of(kPixels, m * (1 + 2 * kFourOfD / 4) + 0.5);
  if (measured) {
    changed_tile_ = changed;
    same_pixel_ = sum_of(9, m * (1 + kFourOfD / 3) + 0.5);
  }
  std::fill(colored_.begin(), colored_.end(), std::uint8_t{0});
  for (int j = 0; j < rows_; ++j) {
    const bool refresh = (frame_ + 1 + j) % kColorEvery == 0;  // learn() will need its colours
    for (int i = 0; i < tiles_; ++i) {
      const bool known = sure_(i, j) >= trust_;
      const bool wanted =
          view != nullptr ? view->needs_color(i, j) != 0 && is_static(i, j) != 0
                          : !known || refresh || strange_(i, j) + 1 >= settings_.frames_to_renew;
      if (wanted) compute_color(color, i, j);
      look_(i, j) = kNothing;
      if (!known || !measured) continue;
      const int now = sum_now_(i, j), then = expected(i, j);
      const int d = sum_difference_(i, j), light = then / kLightShare;
      if (d > changed + light) {
        const bool dim = now < then && 100 * now >= kDarkestShadow * then;
        look_(i, j) = dim && has_hue_of_scene(square_of(color, i, j), 0.5, 0) ? kShadow : kChanged;
      } else if (d <= same + light / 2) {
        look_(i, j) = kSame;
      }
    }
  }
}

// Tests the neighbours of changed tiles, and in turn the neighbours of those that do not pass.
void StaticPicture::spread_changes(const ColorImage& color, const Image<std::uint8_t>& is_static) {
  if (noise_ < 0) return;
  queue_.clear();
  for (int j = 0; j < rows_; ++j) {
    for (int i = 0; i < tiles_; ++i) {
      if (look_(i, j) == kChanged) queue_.push_back(j * tiles_ + i);
    }
  }
  std::fill(tested_.begin(), tested_.end(), std::uint8_t{0});
  for (std::size_t head = 0; head < queue_.size(); ++head) {
    const int i = queue_[head] % tiles_, j = queue_[head] / tiles_;
    for (int b = std::max(j - 1, 0); b <= std::min(j + 1, rows_ - 1); ++b) {
      for (int a = std::max(i - 1, 0); a <= std::min(i + 1, tiles_ - 1); ++a) {
        test_for_chance(color, is_static, a, b);
      }
    }
  }
}

// Corrects the look of a neighbour of a changed tile if it is the same only by chance ("Chance" in
// static_picture.h).
void StaticPicture::test_for_chance(const ColorImage& color, const Image<std::uint8_t>& is_static,
                                    int i, int j) {
  if (look_(i, j) >= kShadow || tested_(i, j) != 0 || sure_(i, j) < trust_ ||
      is_static(i, j) != 0) {
    return;
  }
  tested_(i, j) = 1;
  const Square square = square_of(color, i, j);
  const auto is_scene = [&](double bounds) {
    return has_hue_of_scene(square, bounds, bounds / kLightShare);
  };
  if (is_scene(square.alone ? 1 : 0.5)) return;
  look_(i, j) = is_scene(1) ? kNothing : kChanged;
  queue_.push_back(j * tiles_ + i);
}

void StaticPicture::compute_color(const ColorImage& color, int i, int j) {
  if (colored_(i, j) != 0) return;
  colored_(i, j) = 1;
  colors_now_(i, j) = color_of(color, i, j);
}

// Sums over eight pixels of a tile that are spread over all its rows and columns.
TileColor StaticPicture::color_of(const ColorImage& color, int i, int j) const {
  TileColor sum;
  for (int k = 0; k < 8; ++k) {
    const int x = factor_ == 1 ? k % 4 : (3 * k) % 8;
    const int y = factor_ == 1 ? (k + k / 4) % 4 : k;
    const Rgb c = color(factor_ * kTile * i + x, factor_ * kTile * j + y);
    sum.r = static_cast<std::uint16_t>(sum.r + c.r);
    sum.g = static_cast<std::uint16_t>(sum.g + c.g);
    sum.b = static_cast<std::uint16_t>(sum.b + c.b);
  }
  return sum;
}

// Grey levels: two standard deviations of the difference of a tile's mean colour now and in the
// picture, and 1/2 for rounding.
double StaticPicture::color_noise() const { return 2 * std::sqrt(2.0) * kOfColor * noise_ + 0.5; }

// The sums over the square around a tile that is large enough for the noise ("Squares" in
// static_picture.h).
StaticPicture::Square StaticPicture::square_of(const ColorImage& color, int i, int j) {
  const double now = sum_now_(i, j), then = std::max(expected(i, j), 1);
  const double light = then / kLightShare;
  // The noise of the hue is inversely proportional to the square's side. With this side it is 1/32.
  const double side = kPixels * std::sqrt(2.0) * color_noise() / light;
  const int reach = std::clamp(static_cast<int>(std::ceil((side - 1) / 2)), 0, kLargestSquare);
  const double alike = (kPixels * (kAlike * noise_ + 0.5) + light) / then;
  Square square;
  square.alone = reach == 0;
  for (int b = std::max(j - reach, 0); b <= std::min(j + reach, rows_ - 1); ++b) {
    for (int a = std::max(i - reach, 0); a <= std::min(i + reach, tiles_ - 1); ++a) {
      if (sure_(a, b) < trust_) continue;
      const int expected_here = std::max(expected(a, b), 1);
      if (std::abs(sum_now_(a, b) / static_cast<double>(expected_here) - now / then) > alike) {
        continue;
      }
      compute_color(color, a, b);
      const TileColor &c = colors_now_(a, b), &p = colors_(a, b);
      ++square.tiles;
      square.now += sum_now_(a, b);
      square.expected += expected_here;
      square.color_now = {square.color_now[0] + c.r, square.color_now[1] + c.g,
                          square.color_now[2] + c.b};
      square.color_then = {square.color_then[0] + p.r, square.color_then[1] + p.g,
                           square.color_then[2] + p.b};
    }
  }
  return square;
}

// Whether the ratios of red to green and of blue to green of a square equal those of the picture.
// @param bounds  factor on the noise bound: 1 is the bound for "changed", two standard deviations
// @param light   share of the light that a hand may reflect
bool StaticPicture::has_hue_of_scene(const Square& s, double bounds, double light) const {
  const double L = s.now / static_cast<double>(s.expected);
  const double shade = L < 1 ? std::min(kSunAndSky * (1 - L) / L, kHue) : 0.0;
  const double pixels = 8.0 * s.tiles, level = bounds * color_noise() / std::sqrt(s.tiles);
  const auto is_alike = [&](int part) {
    const double now = s.color_now[part], green = std::max(s.color_now[1], 1);
    const double then = s.color_then[part], green_then = s.color_then[1];
    const double noise = level * pixels * std::hypot(1 / std::max(now, 1.0), 1 / green);
    return std::abs(now * green_then - green * then) <= (shade + light + noise) * green * then;
  };
  return is_alike(0) && is_alike(2);
}

bool StaticPicture::is_same_pixel(int x, int y) const {
  if (x < 1 || y < 1 || x + 1 >= now_.width() || y + 1 >= now_.height() ||
      sure_(x / kTile, y / kTile) < trust_) {
    return false;
  }
  int sum = 0;
  for (int b = y - 1; b <= y + 1; ++b) {
    const std::uint8_t* d = difference_.row(b) + x;
    sum += d[-1] + d[0] + d[1];
  }
  const int light = 9 * picture_(x, y) * gain_ / kUnit / kLightShare;
  return sum <= same_pixel_ + light / 2;
}

bool StaticPicture::distinguishes_pixels(int i, int j) const {
  return kPixels * same_pixel_ <= 9 * 2 * expected(i, j) / kLightShare;
}

bool StaticPicture::is_plain(int i, int j) const {
  std::uint8_t low = 255, high = 0;
  for (int y = kTile * j; y < kTile * j + kTile; ++y) {
    for (int x = kTile * i; x < kTile * i + kTile; ++x) {
      low = std::min(low, now_(x, y));
      high = std::max(high, now_(x, y));
    }
  }
  // The range of sixteen normal values with standard deviation s = 1.25 m is 3.5 s on average, with
  // a standard deviation of 0.75 s. The bound is two of these above the average.
  return high - low <= 1.25 * noise_ * (3.5 + 2 * 0.75) + 1;
}

bool StaticPicture::is_as_ever(int i, int j) const {
  return anew_(i, j) == 0 && (look_(i, j) == kSame || (look_(i, j) == kShadow && is_plain(i, j)));
}

bool StaticPicture::looks_as_ever(int i, int j) const {
  if (i >= tiles_ || j >= rows_ || !is_as_ever(i, j)) return false;
  int alike = 0, there = 0;
  for (int b = std::max(j - 1, 0); b <= std::min(j + 1, rows_ - 1); ++b) {
    for (int a = std::max(i - 1, 0); a <= std::min(i + 1, tiles_ - 1); ++a) {
      ++there;
      alike += is_as_ever(a, b) ? 1 : 0;
    }
  }
  return 2 * alike > there;
}

// Makes the present look of a tile the picture's.
void StaticPicture::take_over(int i, int j) {
  int sum = 0;
  for (int y = kTile * j; y < kTile * j + kTile; ++y) {
    for (int x = kTile * i; x < kTile * i + kTile; ++x) {
      const int value = std::min((now_(x, y) * kUnit + gain_ / 2) / gain_, 255);
      picture_(x, y) = static_cast<std::uint8_t>(value);
      sum += value;
    }
  }
  sum_then_(i, j) = static_cast<std::uint16_t>(sum);
  colors_(i, j) = colors_now_(i, j);
  sure_(i, j) = 1;
  strange_(i, j) = 0;
}

void StaticPicture::learn(const Image<std::uint8_t>& moves, const Image<std::uint8_t>& is_static) {
  const bool at_start = starting();
  ++frame_;
  for (int j = 0; j < rows_; ++j) {
    const bool follow = (frame_ + j) % kFollowEvery == 0;
    const bool refresh = (frame_ + j) % kColorEvery == 0;
    bool any = false;
    for (int i = 0; i < tiles_; ++i) {
      const bool follows = learn_tile(i, j, moves(i, j) == 0 || at_start, is_static(i, j) != 0);
      if (follows && refresh) colors_(i, j) = colors_now_(i, j);
      if (!follow) continue;
      any = any || follows;
      std::fill_n(follows_.begin() + static_cast<std::ptrdiff_t>(kTile) * i, kTile,
                  static_cast<std::uint8_t>(follows ? 255 : 0));
    }
    if (follow && any) follow_row(j);
  }
}

// Updates the state of one tile from one frame.
// @param is_quiet  the mask has it at rest
// @return whether P may follow Y there: the tile is known, at rest and not changed
bool StaticPicture::learn_tile(int i, int j, bool is_quiet, bool is_static) {
  std::uint16_t& strange = strange_(i, j);
  std::uint8_t& sure = sure_(i, j);
  if (sure == 0 || (sure < trust_ && sum_difference_(i, j) > changed_tile_)) {
    take_over(i, j);
  } else if (sure < trust_) {
    sure = static_cast<std::uint8_t>(std::min(sure + (is_quiet ? kQuietCounts : 1), trust_));
    if (!is_quiet) anew_(i, j) = 1;
  } else if (look_(i, j) >= kShadow) {
    const bool is_scene = is_quiet && is_static && look_(i, j) != kShadow;
    if (++strange >= (is_scene ? settings_.frames_to_renew : settings_.frames_to_settle)) {
      take_over(i, j);
      anew_(i, j) = 1;
    }
  } else if (is_quiet || look_(i, j) == kSame) {
    strange = 0;
    return is_quiet;
  }
  return false;
}

// Changes P by one level towards Y / g in those tiles of row j that follow.
void StaticPicture::follow_row(int j) {
  const int width = now_.width();
  std::fill(columns_.begin(), columns_.end(), std::uint16_t{0});
  for (int y = kTile * j; y < kTile * j + kTile; ++y) {
    const std::uint8_t* seen = now_.row(y);
    if (gain_ != kUnit) {
      const int inverse = std::min(kUnit * kUnit / gain_, 65535);
      scale_row(seen, static_cast<std::uint16_t>(inverse), scaled_.data(), width);
      seen = scaled_.data();
    }
    std::uint8_t* p = picture_.row(y);
    for (int x = 0; x < width; ++x) {
      const int step = (seen[x] > p[x] ? 1 : 0) - (seen[x] < p[x] ? 1 : 0);
      p[x] = static_cast<std::uint8_t>(p[x] + (step & follows_[x]));
    }
    add_row(p, columns_.data(), width);
  }
  sums_of(columns_.data(), sum_then_.row(j), tiles_);
}

}  // namespace palpable
