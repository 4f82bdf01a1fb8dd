#include "palpable/live/seen_object/outline_search.h"

#include "palpable/common/base/contract.h"
#include "palpable/live/seen_object/pixel_kernels.h"
#include "palpable/live/seen_object/silhouette.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpable {
namespace {

constexpr int kMostSamples = 32;
constexpr int kLeastInside = 4, kLeastOutside = 3;  // samples of each side
constexpr int kNormalReach = 3;  // px, half the side of the window that gives a border's normal
constexpr int kMedianReach =
    3;  // px along the border, up to which the median of the shifts is taken
// px, the least moment of the pixels in that window: 42 at a straight border, 7 at a side 2 px
// wide. Single holes in a thing have less.
constexpr float kLeastMoment = 6;
constexpr float kSameWay = 0.7F;     // least cosine of the angle between the normals of neighbours
constexpr float kMostBend = 0.125F;  // 1/px, half the largest curvature of a border
constexpr int kDrawReach = 3;        // px from the border that may change
constexpr float kRidge = 4;          // px^2, regularises the slope of a side with few samples

// Whether two depths may belong to one surface, as a silhouette decides it.
bool is_same_depth(float a, float b) {
  return std::abs(a - b) <= depth_jump(SilhouetteSettings(), std::min(a, b));
}

// Sums over the samples of one side, for a straight line through their colours.
struct LineSums {
  float n = 0, t = 0, tt = 0;
  std::array<float, 3> c{}, tc{}, cc{};

  void add(float at, const std::array<float, 3>& color) {
    n += 1, t += at, tt += at * at;
    for (std::size_t k = 0; k < 3; ++k) {
      c[k] += color[k], tc[k] += at * color[k], cc[k] += color[k] * color[k];
    }
  }
  [[nodiscard]] LineSums without(const LineSums& other) const {
    LineSums rest = *this;
    rest.n -= other.n, rest.t -= other.t, rest.tt -= other.tt;
    for (std::size_t k = 0; k < 3; ++k) {
      rest.c[k] -= other.c[k], rest.tc[k] -= other.tc[k], rest.cc[k] -= other.cc[k];
    }
    return rest;
  }
};

// The colour of a side's line at a place, and the sum of squared residuals of its samples.
struct LineFit {
  std::array<float, 3> there{};
  float residual = 0;
};

LineFit fit_line(const LineSums& s, float at) {
  LineFit fit;
  const float mean = s.t / s.n, spread = std::max(s.tt - s.t * mean, 0.0F) + kRidge;
  for (std::size_t k = 0; k < 3; ++k) {
    const float level = s.c[k] / s.n, along = s.tc[k] - s.t * level;
    const float slope = along / spread;
    fit.there[k] = level + slope * (at - mean);
    // Of the regularised line: sum (c - level)^2 - 2 slope along + slope^2 (tt - t mean).
    fit.residual += std::max(
        s.cc[k] - s.c[k] * level - 2 * slope * along + slope * slope * (spread - kRidge), 0.0F);
  }
  return fit;
}

// The outline within one sample of a profile.
struct Crossing {
  float residual = 0;  // sum of squares, of both sides and the sample
  float place = 0;     // t of the outline
  float contrast = 0;  // squared difference of both sides' colours there
};

}  // namespace

// Colours along the normal of a border, one pixel of the picture apart: samples lie at t = 1/2,
// 3/2,
// ... outside and -1/2, -3/2, ... inside of it. The innermost one is the first.
struct OutlineSearch::Profile {
  int inside = 0, count = 0;
  std::array<Color, kMostSamples> colors;
  std::array<LineSums, kMostSamples + 1> sums;  // of the samples before the k-th

  [[nodiscard]] float t(int k) const { return static_cast<float>(k - inside) + 0.5F; }

  // The samples that the outline may cross: with two more on each side.
  [[nodiscard]] int first() const { return 2; }
  [[nodiscard]] int end() const { return count - 2; }

  [[nodiscard]] Crossing crossing(int m) const {
    const auto k = static_cast<std::size_t>(m);
    const LineSums& all = sums[static_cast<std::size_t>(count)];
    const LineFit in = fit_line(sums[k], t(m)), out = fit_line(all.without(sums[k + 1]), t(m));
    float along = 0, apart = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const float d = in.there[c] - out.there[c];
      along += d * (colors[k][c] - out.there[c]);
      apart += d * d;
    }
    const float share = apart > 0 ? std::clamp(along / apart, 0.0F, 1.0F) : 0.5F;
    float off = 0;  // of the mixed sample from the line between both colours
    for (std::size_t c = 0; c < 3; ++c) {
      const float expected = share * in.there[c] + (1 - share) * out.there[c];
      off += (colors[k][c] - expected) * (colors[k][c] - expected);
    }
    return {in.residual + out.residual + off, t(m) - 0.5F + share, apart};
  }
};

OutlineSearch::OutlineSearch(const OutlineSearchSettings& settings) : settings_(settings) {
  PALPABLE_EXPECT(settings.inside == 0 ||
                      (settings.inside >= kLeastInside && settings.outside >= kLeastOutside &&
                       settings.inside + settings.outside < kMostSamples),
                  "samples on both sides, and room for them");
  PALPABLE_EXPECT(settings.spread > 0 && settings.least_noise > 0 && settings.least_contrast > 0,
                  "spread, noise and contrast are above 0");
}

// Whether the thing goes on behind a hole without depth that begins at a pixel of its border.
bool OutlineSearch::goes_on(const SeenFrame& seen, const MaskImage& shows, int x, int y, float nx,
                            float ny) const {
  for (int k = 1; k <= SilhouetteSettings().longest_hole; ++k) {
    const int u = x + static_cast<int>(std::lround(static_cast<float>(k) * nx));
    const int v = y + static_cast<int>(std::lround(static_cast<float>(k) * ny));
    if (!box_.contains(u, v)) return false;
    if (!is_depth(seen.depth(u, v))) continue;
    return shows(u, v) == kShowsPresser && is_same_depth(seen.depth(u, v), seen.depth(x, y));
  }
  return false;
}

// Finds the pixels of pressers beside others, and their normals. Beside the box nothing is known,
// so its outermost pixels have none.
void OutlineSearch::find_border(const SeenFrame& seen, const MaskImage& shows) {
  border_.clear();
  const int left = box_.x + kNormalReach, right = box_.x + box_.width - kNormalReach;
  const int top = box_.y + kNormalReach, bottom = box_.y + box_.height - kNormalReach;
  for (int y = top; y < bottom; ++y) {
    const std::uint8_t *row = shows.row(y), *above = shows.row(y - 1), *below = shows.row(y + 1);
    for (int x = left; x < right; ++x) {
      if (row[x] != kShowsPresser) continue;
      const int beside = row[x - 1] & row[x + 1] & above[x] & below[x];
      if (beside == kShowsPresser) continue;
      const float z = seen.depth(x, y);
      if (!is_depth(z)) continue;
      // Something nearer beside it hides the thing: its outline is not there.
      bool is_hidden = false, is_measured = false;
      for (const auto& [dx, dy] :
           {std::array{-1, 0}, std::array{1, 0}, std::array{0, -1}, std::array{0, 1}}) {
        if (shows(x + dx, y + dy) == kShowsPresser) continue;
        const float other = seen.depth(x + dx, y + dy);
        if (!is_depth(other)) continue;
        is_measured = true;
        is_hidden = is_hidden || (other < z && !is_same_depth(other, z));
      }
      if (is_hidden) continue;
      float nx = 0, ny = 0;
      for (int dy = -kNormalReach; dy <= kNormalReach; ++dy) {
        const std::uint8_t* of = shows.row(y + dy) + x;
        for (int dx = -kNormalReach; dx <= kNormalReach; ++dx) {
          if (of[dx] != kShowsPresser) continue;
          nx -= static_cast<float>(dx), ny -= static_cast<float>(dy);
        }
      }
      const float length = std::sqrt(nx * nx + ny * ny);
      if (!(length > kLeastMoment)) continue;
      if (!is_measured && goes_on(seen, shows, x, y, nx / length, ny / length)) continue;
      border_at_(x, y) = static_cast<std::int32_t>(border_.size()) + 1;
      border_.push_back({static_cast<std::int16_t>(x), static_cast<std::int16_t>(y), nx / length,
                         ny / length, is_measured ? static_cast<float>(settings_.expected) : 0.0F});
    }
  }
}

// @return whether both sides have enough samples
bool OutlineSearch::sample(const SeenFrame& seen, const MaskImage& shows, const Border& at,
                           Profile& profile) const {
  const auto factor = static_cast<float>(factor_);
  // Pixel x of the depth image lies at factor x + (factor - 1) / 2 of the picture.
  const float u0 = factor * static_cast<float>(at.x) + 0.5F * (factor - 1) + 0.5F * factor * at.nx;
  const float v0 = factor * static_cast<float>(at.y) + 0.5F * (factor - 1) + 0.5F * factor * at.ny;
  const float z = seen.depth(at.x, at.y);
  const int width = factor_ * shows.width(), height = factor_ * shows.height();
  // The pixel of the picture above and left of a place.
  const auto pixel_at = [&](float t) {
    return std::array{static_cast<int>(std::floor(u0 + t * at.nx)),
                      static_cast<int>(std::floor(v0 + t * at.ny))};
  };
  const auto is_within = [&](float t) {
    const auto [u, v] = pixel_at(t);
    return u >= 0 && v >= 0 && u + 1 < width && v + 1 < height;
  };
  // Whether the pixel of the depth image that holds a place shows any presser; this one.
  const auto owner_at = [&](float t) {
    return std::array{static_cast<int>(std::floor(u0 + t * at.nx + 0.5F)) / factor_,
                      static_cast<int>(std::floor(v0 + t * at.ny + 0.5F)) / factor_};
  };
  const auto shows_any = [&](float t) {
    const auto [x, y] = owner_at(t);
    return shows(x, y) == kShowsPresser;
  };
  const auto shows_thing = [&](float t) {
    const auto [x, y] = owner_at(t);
    return shows(x, y) == kShowsPresser && is_same_depth(seen.depth(x, y), z);
  };
  // The first two samples of each side are of the border pixel and the one beside it.
  int in = 0, out = 0;
  while (in < settings_.inside) {
    const float t = -0.5F - static_cast<float>(in);
    if (!is_within(t) || (in > 1 && !shows_thing(t))) break;
    ++in;
  }
  while (out < settings_.outside) {
    const float t = 0.5F + static_cast<float>(out);
    if (!is_within(t) || (out > 1 && shows_any(t))) break;
    ++out;
  }
  if (in < kLeastInside || out < kLeastOutside) return false;
  profile.inside = in;
  profile.count = in + out;
  profile.sums[0] = {};
  for (int k = 0; k < profile.count; ++k) {
    const float t = profile.t(k);
    const auto p = pixel_at(t);
    const float a = u0 + t * at.nx - static_cast<float>(p[0]);
    const float b = v0 + t * at.ny - static_cast<float>(p[1]);
    const Rgb *first = seen.color.row(p[1]) + p[0], *second = seen.color.row(p[1] + 1) + p[0];
    const auto mixed = [&](auto channel) {
      return (1 - b) * ((1 - a) * static_cast<float>(channel(first[0])) +
                        a * static_cast<float>(channel(first[1]))) +
             b * ((1 - a) * static_cast<float>(channel(second[0])) +
                  a * static_cast<float>(channel(second[1])));
    };
    const auto at_k = static_cast<std::size_t>(k);
    profile.colors[at_k] = {mixed([](const Rgb& c) { return c.r; }),
                            mixed([](const Rgb& c) { return c.g; }),
                            mixed([](const Rgb& c) { return c.b; })};
    profile.sums[at_k + 1] = profile.sums[at_k];
    profile.sums[at_k + 1].add(t, profile.colors[at_k]);
  }
  return true;
}

void OutlineSearch::search(const SeenFrame& seen, const MaskImage& shows, Border& at) const {
  Profile profile;
  if (!sample(seen, shows, at, profile)) return;
  std::array<Crossing, kMostSamples> crossings;
  float least = std::numeric_limits<float>::infinity();
  for (int m = profile.first(); m < profile.end(); ++m) {
    const Crossing& crossing = crossings[static_cast<std::size_t>(m)] = profile.crossing(m);
    least = std::min(least, crossing.residual);
  }
  // The noise is estimated from the best fit.
  const auto least_noise = static_cast<float>(settings_.least_noise);
  const float noise2 =
      std::max(least_noise * least_noise, least / (3 * static_cast<float>(profile.count - 4)));
  const auto spread = static_cast<float>(settings_.spread);
  float best = std::numeric_limits<float>::infinity();
  const Crossing* found = nullptr;
  for (int m = profile.first(); m < profile.end(); ++m) {
    const Crossing& crossing = crossings[static_cast<std::size_t>(m)];
    const float shift = crossing.place / static_cast<float>(factor_);
    if (std::abs(shift) > kDrawReach) continue;  // draw() could not follow
    const float off = (shift - at.expected) / spread;
    const float cost = crossing.residual / (2 * noise2) + 0.5F * off * off;
    if (cost < best) best = cost, found = &crossing;
  }
  const auto contrast = static_cast<float>(settings_.least_contrast);
  if (found == nullptr || found->contrast < contrast * contrast * noise2) return;
  at.shift = found->place / static_cast<float>(factor_);
  at.is_found = true;
}

// The median of the shifts of neighbours, each as seen from the pixel's own border: with the
// tangent there, and the curvature of the border.
void OutlineSearch::find_medians() {
  for (Border& at : border_) {
    beside_.clear();
    // Sums over the border: of 1, s^2, s^4, the distance h outside of the tangent, and s^2 h, with
    // s the place along the tangent.
    float all = 0, s2 = 0, s4 = 0, h1 = 0, s2h = 0;
    for (int y = at.y - kMedianReach; y <= at.y + kMedianReach; ++y) {
      for (int x = at.x - kMedianReach; x <= at.x + kMedianReach; ++x) {
        if (!box_.contains(x, y)) continue;
        const std::int32_t index = border_at_(x, y);
        if (index == 0) continue;
        const Border& other = border_[static_cast<std::size_t>(index - 1)];
        if (other.nx * at.nx + other.ny * at.ny < kSameWay) continue;
        const auto dx = static_cast<float>(other.x - at.x);
        const auto dy = static_cast<float>(other.y - at.y);
        const float s = at.nx * dy - at.ny * dx, h = at.nx * dx + at.ny * dy;
        all += 1, s2 += s * s, s4 += s * s * s * s, h1 += h, s2h += s * s * h;
        if (other.is_found) beside_.push_back({other.shift + h, s * s});
      }
    }
    at.is_known = 2 * static_cast<float>(beside_.size()) > all && beside_.size() >= 2;
    if (!at.is_known) continue;
    const float spread = s4 - s2 * s2 / all;
    const float bend =
        spread > 1 ? std::clamp((s2h - s2 * h1 / all) / spread, -kMostBend, kMostBend) : 0;
    shifts_.clear();
    for (const auto& [shift, squared] : beside_) shifts_.push_back(shift - bend * squared);
    const auto middle = shifts_.begin() + std::ssize(shifts_) / 2;
    std::nth_element(shifts_.begin(), middle, shifts_.end());
    at.median = *middle;
  }
}

// Gives each pixel near the border its share, by the border pixel that is nearest to it. Where that
// one's outline is not known, the pixel stays as it is.
void OutlineSearch::draw(const SeenFrame& seen, MaskImage& shows) {
  for (const Border& at : border_) {
    const float z = seen.depth(at.x, at.y);
    for (int dy = -kDrawReach; dy <= kDrawReach; ++dy) {
      for (int dx = -kDrawReach; dx <= kDrawReach; ++dx) {
        const int x = at.x + dx, y = at.y + dy;
        if (!box_.contains(x, y)) continue;
        const auto far = static_cast<float>(dx * dx + dy * dy);
        if (!(far < nearest_(x, y))) continue;
        if (shows(x, y) == kShowsPresser && !is_same_depth(seen.depth(x, y), z)) continue;
        nearest_(x, y) = far;
        is_known_(x, y) = at.is_known ? 1 : 0;
        const float inside =
            0.5F + at.median - at.nx * static_cast<float>(dx) - at.ny * static_cast<float>(dy);
        if (at.is_known) coverage_(x, y) = std::clamp(0.5F + inside, 0.0F, 1.0F);
      }
    }
  }
  for (const Border& at : border_) {
    for (int y = at.y - kDrawReach; y <= at.y + kDrawReach; ++y) {
      for (int x = at.x - kDrawReach; x <= at.x + kDrawReach; ++x) {
        if (!box_.contains(x, y) || std::isinf(nearest_(x, y))) continue;
        nearest_(x, y) = std::numeric_limits<float>::infinity();
        const bool is_thing = shows(x, y) == kShowsPresser;
        if (is_known_(x, y) == 0) {
          coverage_(x, y) = is_thing ? 1.0F : 0.0F;
        } else if (is_thing) {
          if (coverage_(x, y) <= 0.5F) shows(x, y) = kShowsRoomByEdge;
        } else {
          coverage_(x, y) = std::min(coverage_(x, y), 0.5F);
          if (shows_room(shows(x, y))) shows(x, y) = kShowsRoomByEdge;
        }
      }
    }
  }
}

void OutlineSearch::find(const SeenFrame& seen, const PixelBox& box, MaskImage& shows) {
  const int width = shows.width(), height = shows.height();
  factor_ = seen.color.width() / std::max(width, 1);
  if (coverage_.width() != width || coverage_.height() != height) {
    coverage_ = Image<float>(width, height);
    nearest_ = Image<float>(width, height);
    std::fill(nearest_.begin(), nearest_.end(), std::numeric_limits<float>::infinity());
    border_at_ = Image<std::int32_t>(width, height);
    border_.reserve(shows.size());
    is_known_ = MaskImage(width, height);
    beside_.reserve((2 * kMedianReach + 1) * (2 * kMedianReach + 1));
    shifts_.reserve(beside_.capacity());
  }
  box_ = box;
  for (int y = box.y; y < box.y + box.height; ++y) {
    for (int x = box.x; x < box.x + box.width; ++x) {
      coverage_(x, y) = shows(x, y) == kShowsPresser ? 1.0F : 0.0F;
    }
  }
  if (settings_.inside == 0 || factor_ < 1 || seen.color.width() - factor_ * width >= factor_ ||
      seen.color.height() < factor_ * height) {
    return;
  }
  find_border(seen, shows);
  for (Border& at : border_) search(seen, shows, at);
  find_medians();
  draw(seen, shows);
  for (const Border& at : border_) border_at_(at.x, at.y) = 0;
}

}  // namespace palpable
