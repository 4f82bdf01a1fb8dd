#include "palpable/map/static_picture.h"

#include "palpable/base/contract.h"

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

constexpr int kTile = 4;      // px
constexpr int kPixels = 16;   // of a tile
constexpr int kUnit = 512;    // of the gain
constexpr int kSteps = 4096;  // of the histograms
// Tiles that are nearly black or clipped say nothing about the gain.
constexpr int kDarkest = 4 * kPixels, kBrightest = 240 * kPixels;
// Fewer static tiles say nothing about gain and noise: those of the frame before stay.
constexpr int kFewest = 50;
// A frame in which nothing is said to move counts so often: what may be a hand at rest must look
// the same for five times as long.
constexpr int kQuietCounts = 5;
// The picture follows what is seen in every so many frames; its colours, which hardly change, less
// often.
constexpr int kFollowEvery = 4, kColorEvery = 32;

// Four deviations of a mean of D, three of a mean of Y - g P, in m (static_picture.h); twice that
// for what has changed.
constexpr double kFourOfD = 4.24, kThreeOfY = 5.3;
constexpr int kLightShare = 32;
constexpr int kDarkestShadow = 40;  // %: darker things are things
constexpr double kHue = 0.07;       // share; the sky's light against sun and sky: 0.04 and 0.06

void halve_rows(const std::uint8_t* a, const std::uint8_t* b, std::uint8_t* half, int width) {
  for (int x = 0; x < width; ++x) {
    const int sum = a[2 * x] + a[2 * x + 1] + b[2 * x] + b[2 * x + 1];
    half[x] = static_cast<std::uint8_t>((sum + 2) >> 2);
  }
}

void add_row(const std::uint8_t* row, std::uint16_t* columns, int width) {
  for (int x = 0; x < width; ++x) columns[x] = static_cast<std::uint16_t>(columns[x] + row[x]);
}

void sums_of(const std::uint16_t* columns, std::uint16_t* sums, int tiles) {
  for (int i = 0; i < tiles; ++i) {
    const std::uint16_t* c = columns + static_cast<std::ptrdiff_t>(kTile) * i;
    sums[i] = static_cast<std::uint16_t>(c[0] + c[1] + c[2] + c[3]);
  }
}

// Times factor / 512, at most 255.
void scale_row(const std::uint8_t* row, std::uint16_t factor, std::uint8_t* scaled, int width) {
  for (int x = 0; x < width; ++x) {
    const auto wide = static_cast<std::uint32_t>(row[x]) << 7;
    const auto value = static_cast<std::uint16_t>(wide * factor >> 16);
    scaled[x] = static_cast<std::uint8_t>(std::min<std::uint16_t>(value, 255));
  }
}

int middle_of(const std::vector<int>& histogram, int count) {
  int below = 0, at = 0;
  while (at < kSteps - 1 && 2 * (below + histogram[static_cast<std::size_t>(at)]) < count) {
    below += histogram[static_cast<std::size_t>(at++)];
  }
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
  ++frame_;  // it was seen, too: a camera that moves from the first frame on does not start for
             // ever
  std::fill(sure_.begin(), sure_.end(), std::uint8_t{0});
}

void StaticPicture::resize(int width, int height, const Image<std::uint8_t>& tiles) {
  if (now_.width() == width && now_.height() == height) return;
  now_ = picture_ = difference_ = GrayImage(width, height);
  look_ = sure_ = Image<std::uint8_t>(tiles.width(), tiles.height());
  sum_now_ = sum_then_ = sum_difference_ = strange_ =
      Image<std::uint16_t>(tiles.width(), tiles.height());
  colors_ = colors_now_ = Image<TileColor>(tiles.width(), tiles.height());
  columns_.resize(static_cast<std::size_t>(width));
  scaled_.resize(columns_.size());
  follows_.resize(columns_.size());
  tiles_ = width / kTile;
  rows_ = height / kTile;
}

bool StaticPicture::compare(const GrayImage& luma, const ColorImage& color, int width, int height,
                            const Image<std::uint8_t>& is_static) {
  const int factor = width > 0 ? luma.width() / width : 0;
  if (factor < 1 || factor > 2 || luma.height() / factor != height ||
      color.width() != luma.width() || color.height() != luma.height()) {
    return false;
  }
  factor_ = factor;
  resize(width, height, is_static);
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
  find_gain(is_static);
  find_differences();
  find_noise(is_static);
  find_looks(color);
  return true;
}

void StaticPicture::find_gain(const Image<std::uint8_t>& is_static) {
  std::fill(histogram_.begin(), histogram_.end(), 0);
  int count = 0;
  for (int j = 0; j < rows_; j += 2) {  // a quarter of them will do
    for (int i = 0; i < tiles_; i += 2) {
      const int then = sum_then_(i, j), now = sum_now_(i, j);
      if (is_static(i, j) == 0 || sure_(i, j) < trust_ || then < kDarkest || then > kBrightest ||
          now > kBrightest) {
        continue;
      }
      ++histogram_[static_cast<std::size_t>(std::min(kUnit * now / then, kSteps - 1))];
      ++count;
    }
  }
  if (count >= kFewest) gain_ = std::max(middle_of(histogram_, count), 1);
  if (std::abs(gain_ - kUnit) <= 2) gain_ = kUnit;  // 0.4 %: nothing has changed
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
  if (count >= kFewest) noise_ = static_cast<double>(middle_of(histogram_, count)) / kPixels;
}

void StaticPicture::find_looks(const ColorImage& color) {
  const bool measured = noise_ >= 0;
  const double m = measured ? noise_ : 0;
  const auto sum_of = [](int n, double mean) { return static_cast<int>(n * mean); };
  const int same = sum_of(kPixels, m * (1 + kFourOfD / 4) + 0.5);
  const int same_mean = sum_of(kPixels, m * kThreeOfY / 4 + 0.5);
  const int changed = sum_of(kPixels, m * (1 + 2 * kFourOfD / 4) + 0.5);
  const int changed_mean = sum_of(kPixels, m * 2 * kThreeOfY / 4 + 0.5);
  if (measured) {
    changed_tile_ = changed;
    same_pixel_ = sum_of(9, m * (1 + kFourOfD / 3) + 0.5);
    changed_pixel_ = sum_of(9, m * (1 + 2 * kFourOfD / 3) + 0.5);
  }
  for (int j = 0; j < rows_; ++j) {
    const bool refresh = (frame_ + 1 + j) % kColorEvery == 0;  // learn() takes it
    for (int i = 0; i < tiles_; ++i) {
      const bool known = sure_(i, j) >= trust_;
      if (!known || refresh) colors_now_(i, j) = color_of(color, i, j);
      look_(i, j) = kNothing;
      if (!known || !measured) continue;
      const int now = sum_now_(i, j), foretold = sum_then_(i, j) * gain_ / kUnit;
      const int d = sum_difference_(i, j), mean = std::abs(now - foretold);
      const int light = foretold / kLightShare;
      if (d > changed + light || mean > changed_mean + light) {
        const bool dim = now < foretold && 100 * now >= kDarkestShadow * foretold;
        if (dim || strange_(i, j) + 1 >= settings_.frames_to_renew) {
          colors_now_(i, j) = color_of(color, i, j);
        }
        look_(i, j) = dim && has_hue_of_scene(i, j, foretold) ? kShadow : kChanged;
      } else if (d <= same + light / 2 && mean <= same_mean + light / 4) {
        look_(i, j) = kSame;
      }
    }
  }
}

// Over eight pixels that lie in all rows and columns.
StaticPicture::TileColor StaticPicture::color_of(const ColorImage& color, int i, int j) const {
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

// Whether red : green and blue : green are the picture's.
bool StaticPicture::has_hue_of_scene(int i, int j, int foretold) const {
  const TileColor &now = colors_now_(i, j), &then = colors_(i, j);
  const double share = std::min(kHue + kPixels * noise_ / std::max(foretold, 1), 1.5 * kHue);
  const auto alike = [&](int a, int b) { return std::abs(a - b) <= share * b; };
  return alike(now.r * then.g, now.g * then.r) && alike(now.b * then.g, now.g * then.b);
}

StaticPicture::Look StaticPicture::pixel(int x, int y) const {
  const int i = x / kTile, j = y / kTile;
  if (x < 1 || y < 1 || x + 1 >= now_.width() || y + 1 >= now_.height() || sure_(i, j) < trust_) {
    return kNothing;
  }
  int sum = 0;
  for (int b = y - 1; b <= y + 1; ++b) {
    const std::uint8_t* d = difference_.row(b) + x;
    sum += d[-1] + d[0] + d[1];
  }
  const int light = 9 * picture_(x, y) * gain_ / kUnit / kLightShare;
  if (sum <= same_pixel_ + light / 2) return kSame;
  return sum > changed_pixel_ + light && look_(i, j) != kShadow ? kChanged : kNothing;
}

bool StaticPicture::is_plain(int i, int j) const {
  std::uint8_t low = 255, high = 0;
  for (int y = kTile * j; y < kTile * j + kTile; ++y) {
    for (int x = kTile * i; x < kTile * i + kTile; ++x) {
      low = std::min(low, now_(x, y));
      high = std::max(high, now_(x, y));
    }
  }
  // Sixteen values of deviation s = 1.25 m span 3.5 s on average, with a deviation of 0.75 s.
  return high - low <= 1.25 * noise_ * (3.5 + 2 * 0.75) + 1;
}

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
      std::uint16_t& strange = strange_(i, j);
      std::uint8_t& sure = sure_(i, j);
      const bool quiet = moves(i, j) == 0 || at_start;
      bool takes = false;
      if (sure == 0 || (sure < trust_ && sum_difference_(i, j) > changed_tile_)) {
        take_over(i, j);
      } else if (sure < trust_) {
        sure = static_cast<std::uint8_t>(std::min(sure + (quiet ? kQuietCounts : 1), trust_));
      } else if (look_(i, j) >= kShadow) {
        const bool scene = quiet && is_static(i, j) != 0;
        if (++strange >= (scene ? settings_.frames_to_renew : settings_.frames_to_settle)) {
          take_over(i, j);
        }
      } else if (quiet || look_(i, j) == kSame) {
        strange = 0;
        takes = quiet;
      }
      if (takes && refresh) colors_(i, j) = colors_now_(i, j);
      if (!follow) continue;
      any = any || takes;
      std::fill_n(follows_.begin() + static_cast<std::ptrdiff_t>(kTile) * i, kTile,
                  static_cast<std::uint8_t>(takes ? 255 : 0));
    }
    if (follow && any) follow_row(j);
  }
}

// Moves the picture by one level towards what is seen, in the tiles of row j that follow.
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
      p[x] = static_cast<std::uint8_t>(p[x] + (step & follows_[static_cast<std::size_t>(x)]));
    }
    add_row(p, columns_.data(), width);
  }
  sums_of(columns_.data(), sum_then_.row(j), tiles_);
}

}  // namespace palpable
