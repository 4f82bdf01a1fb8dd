#include "palpable/live/seen_object/creases.h"

#include "palpable/common/base/contract.h"
#include "palpable/live/seen_object/pixel_kernels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace palpable {
namespace {

using Eigen::Vector2f;

// Half a chord, as a ratio to the largest ball's radius. Longer chords do not fit into the valley
// between two fingers; the sag of shorter ones is smaller than the noise.
constexpr float kHalfChord = 1.0f / 3;
constexpr int kLeastHalfChord = 2;  // px
constexpr float kRoot = 1.41421356f;

// The directions of chords, diagonal ones last.
constexpr std::array<std::pair<int, int>, 4> kPixelDirections{{{1, 0}, {0, 1}, {1, 1}, {1, -1}}};

// px at the box's rim that are left out, so that every concave pixel has eight neighbours.
constexpr int kRim = 2;

constexpr int kChunk = 64;  // px of a row that find_hollow() tests in one call

// px around a pixel of a crease from which the crease's direction is found.
constexpr int kAlong = 4;

// px from the middle of a crease within which the matcher mixes the depths of both things.
constexpr float kSmeared = 1.5f;

// The least sine of the slope at a crease. Below it the crease would lie on the far half of the
// thing's section, and the estimate of the hidden part diverges.
constexpr double kLeastSine = -0.4;

constexpr double kLeastSlopePixels = 8;  // needed to fit a slope
constexpr std::size_t kSlopeRoom = 8;    // memory is reserved for one crease pixel in this many

constexpr double kLeastSlopeSpread = 0.1;  // px^4; below it the pixels lie on one line

}  // namespace

int Creases::px_at(float metres, float inverse_depth) const {
  return static_cast<int>(std::lround(metres * fx_px_ * inverse_depth));
}

void Creases::smooth(const DepthImage& depth, const Silhouette& silhouette) {
  const std::size_t width = static_cast<std::size_t>(box_.width);
  const std::size_t count = width * static_cast<std::size_t>(box_.height);
  // Reserved for the whole image: the next box may be larger, and the first crease may come then.
  for (std::vector<float>* values : {&inverse_, &mean_}) values->reserve(depth.size());
  places_.reserve(depth.size());
  hollow_.reserve(depth.size());
  group_.reserve(depth.size() / kSlopeRoom);
  pixels_.reserve(depth.size() / kSlopeRoom);
  for (std::vector<float>* values : {&inverse_, &mean_}) values->assign(count, 0.0f);
  if (places_.size() < count) places_.resize(count);
  for (int y = 0; y < box_.height; ++y) {
    const auto [begin, end] = silhouette.things_of_row(box_.y + y);
    const DistanceRow row = silhouette.distances(begin, box_.y + y);
    float* inverse = inverse_.data() + index(begin - box_.x, y);
    for (int x = 0; x < end - begin; ++x) {
      const float w = 1 / row.depth[x];
      inverse[x] = row.distance[x] > 0 ? w : 0.0f;
    }
  }
  const DepthJump& jump = silhouette.jump();
  for (int y = 1; y + 1 < box_.height; ++y) {
    const auto run = silhouette.things_of_row(box_.y + y);
    const int begin = std::max(1, run.begin - box_.x);
    const int end = std::min(box_.width - 1, run.end - box_.x);
    if (begin >= end) continue;
    const float* row = inverse_.data() + index(begin, y);
    best_pixel_kernels().mean_of_nine(row - width, row, row + width, end - begin, jump,
                                      mean_.data() + index(begin, y));
  }
}

// Measures the sag at a pixel, the distance from a chord between two pixels on either side back to
// the surface, and notes it if the surface is concave there with a radius below most_radius. In a
// sphere of radius R the sag of a chord of length l is l^2 / (8 R). Under perspective the middle of
// a chord has the mean of the inverse depths of its ends.
void Creases::measure_sag(int x, int y) {
  const std::size_t at = index(x, y);
  const float z = 1 / mean_[at];
  const float half = kHalfChord * radius_ * fx_px_ * mean_[at];
  const auto width = static_cast<std::ptrdiff_t>(box_.width);
  for (const bool slanted : {false, true}) {
    const float step = slanted ? kRoot : 1.0f;
    const int n = std::max(kLeastHalfChord, static_cast<int>(half / step + 0.5f));
    if (!has(x - n, y - n) || !has(x + n, y + n)) continue;
    const float across = 2 * static_cast<float>(n) * step * z / fx_px_;
    const float shallow = z - across * across / (8 * radius_);
    for (std::size_t d = slanted ? 2 : 0; d < (slanted ? 4 : 2); ++d) {
      const auto [dx, dy] = kPixelDirections[d];
      const auto away = static_cast<std::ptrdiff_t>(n) * (dx + dy * width);
      const float* middle = &mean_[at];
      const float w1 = *(middle - away), w2 = *(middle + away);
      // Rejects most pixels without a division: z - 2 / (w1 + w2) <= across^2 / (8 R).
      if (shallow * (w1 + w2) <= 2 || w1 == 0 || w2 == 0) continue;
      const float along_ray = z - 2 / (w1 + w2), back = 1 / w1 - 1 / w2;
      const float length2 = across * across + back * back;
      const float sag = along_ray * across / std::sqrt(length2);
      Place& here = places_[at];
      if (8 * sag * radius_ > length2 && sag > here.sag) {
        if (here.sag == 0) hollow_.push_back(at);
        here.sag = sag;
        here.direction = static_cast<std::uint8_t>(d);
      }
    }
  }
}

// Gathers the concave pixels that are connected with `first`. If the group is long enough, marks
// its middle line: the pixels whose sag is not exceeded by the neighbours along their chord.
void Creases::gather(std::size_t first) {
  const auto width = static_cast<std::size_t>(box_.width);
  group_.clear();
  group_.push_back(first);
  places_[first].gathered = true;
  std::size_t left = width, right = 0, up = places_.size(), down = 0;
  for (std::size_t k = 0; k < group_.size(); ++k) {
    const std::size_t at = group_[k], x = at % width, y = at / width;
    left = std::min(left, x), right = std::max(right, x);
    up = std::min(up, y), down = std::max(down, y);
    for (const std::size_t row : {at - width, at, at + width}) {
      for (std::size_t n = row - 1; n <= row + 1; ++n) {
        if (places_[n].sag == 0 || places_[n].gathered) continue;
        places_[n].gathered = true;
        group_.push_back(n);
      }
    }
  }
  const double long_enough = px_at(2 * radius_, mean_[first]);
  if (std::hypot(static_cast<double>(right - left), static_cast<double>(down - up)) < long_enough) {
    return;
  }
  for (const std::size_t at : group_) {
    const auto [dx, dy] = kPixelDirections[places_[at].direction];
    const int x = static_cast<int>(at % width), y = static_cast<int>(at / width);
    const float before = places_[index(x - dx, y - dy)].sag;
    const float after = places_[index(x + dx, y + dy)].sag;
    places_[at].is_middle = places_[at].sag >= before && places_[at].sag > after;
  }
}

// The unit vector perpendicular to the crease's middle line at a pixel.
Vector2f Creases::across(int x0, int y0) const {
  double xx = 0, xy = 0, yy = 0;
  for (int y = std::max(0, y0 - kAlong); y <= std::min(box_.height - 1, y0 + kAlong); ++y) {
    for (int x = std::max(0, x0 - kAlong); x <= std::min(box_.width - 1, x0 + kAlong); ++x) {
      if (!places_[index(x, y)].is_middle) continue;
      const int dx = x - x0, dy = y - y0;
      xx += dx * dx, xy += dx * dy, yy += dy * dy;
    }
  }
  const auto along = static_cast<float>(std::atan2(2 * xy, xx - yy) / 2);
  return {-std::sin(along), std::cos(along)};
}

bool Creases::has_middle_near(int x, int y) const {
  const std::size_t k = index(x, y);
  return places_[k].is_middle || (x > 0 && places_[k - 1].is_middle) ||
         (x + 1 < box_.width && places_[k + 1].is_middle);
}

// The visible width (px) of a thing: from the crease at (x0, y0) to its outline or the next crease.
// Nothing when that lies outside of the box or farther than the largest ball's diameter.
std::optional<int> Creases::width_of(const Silhouette& silhouette, int x0, int y0,
                                     const Vector2f& away) const {
  const int most = px_at(2 * radius_, mean_[index(x0, y0)]);
  constexpr int kFirst = 2;  // px: the first pixel beside the crease
  float last = 0;
  for (int k = kFirst; k < most; ++k) {
    const int x = x0 + static_cast<int>(std::lround(static_cast<float>(k) * away.x()));
    const int y = y0 + static_cast<int>(std::lround(static_cast<float>(k) * away.y()));
    if (!has(x, y)) return std::nullopt;
    const float w = mean_[index(x, y)];
    if (w == 0) return k;
    if (k > kFirst + 1 && (!silhouette.joined(last, 1 / w) || has_middle_near(x, y))) return k;
    last = 1 / w;
  }
  return std::nullopt;
}

// Fits a plane to the pixels about half a chord beside the crease: 1/Z is linear in the picture for
// a plane. Nothing if the thing's width is not known.
std::optional<Creases::Side> Creases::side_of(const Silhouette& silhouette, int x0, int y0,
                                              const Vector2f& away) const {
  const std::optional<int> width = width_of(silhouette, x0, y0, away);
  if (!width) return std::nullopt;
  const int half = std::max(kLeastHalfChord, px_at(kHalfChord * radius_, mean_[index(x0, y0)]));
  const int reach = std::max(kLeastHalfChord, half - 1);
  const auto at = static_cast<float>(std::min(half + 1, std::max(2, *width / 2)));
  const int xm = x0 + static_cast<int>(std::lround(at * away.x()));
  const int ym = y0 + static_cast<int>(std::lround(at * away.y()));
  const float zm = 1 / mean_[index(xm, ym)];
  double s = 0, sp = 0, sq = 0, sw = 0, spp = 0, spq = 0, sqq = 0, spw = 0, sqw = 0;
  for (int y = std::max(0, ym - reach); y <= std::min(box_.height - 1, ym + reach); ++y) {
    for (int x = std::max(0, xm - reach); x <= std::min(box_.width - 1, xm + reach); ++x) {
      const float w = inverse_[index(x, y)];
      if (w == 0 || !silhouette.joined(zm, 1 / w)) continue;
      const Vector2f d(static_cast<float>(x - x0), static_cast<float>(y - y0));
      const float p = d.dot(away), q = d.x() * away.y() - d.y() * away.x();
      if (p < kSmeared || p > static_cast<float>(*width) - 0.5f) continue;
      s += 1, sp += p, sq += q, sw += w;
      spp += p * p, spq += p * q, sqq += q * q, spw += p * w, sqw += q * w;
    }
  }
  Side side{*width};
  if (s < kLeastSlopePixels) return side;
  const double mp = sp / s, mq = sq / s, mw = sw / s;
  const double cpp = spp / s - mp * mp, cpq = spq / s - mp * mq, cqq = sqq / s - mq * mq;
  const double cpw = spw / s - mp * mw, cqw = sqw / s - mq * mw;
  const double determinant = cpp * cqq - cpq * cpq;
  if (!(determinant > kLeastSlopeSpread)) return side;
  // dZ = -Z^2 dw, and a pixel is Z / f wide.
  const double slope_of = static_cast<double>(fx_px_) / mw / determinant;
  side.slope = (cqq * cpw - cpq * cqw) * slope_of;
  side.along = (cpp * cqw - cpq * cpw) * slope_of;
  side.at_px = mp;
  return side;
}

// How far (px) a thing continues behind the crease; see the head of the header.
std::optional<float> Creases::hidden_px(const Silhouette& silhouette, int x, int y,
                                        const Vector2f& away) const {
  const std::optional<Side> side = side_of(silhouette, x, y, away);
  if (!side) return std::nullopt;
  if (side->at_px == 0) return 0.0f;
  // The component of the front's normal towards the crease.
  const double sine =
      std::clamp(side->slope / std::sqrt(1 + side->along * side->along + side->slope * side->slope),
                 kLeastSine, 1.0);
  const double hidden = (side->width_px * (1 - sine) - 2 * side->at_px) / (1 + sine);
  return static_cast<float>(std::max(0.0, hidden));
}

void Creases::find(const DepthImage& depth, const PinholeCamera& camera,
                   const Silhouette& silhouette, double most_radius) {
  PALPABLE_EXPECT(most_radius > 0, "the largest ball has a radius");
  box_ = silhouette.box();
  fx_px_ = static_cast<float>(camera.fx_px);
  radius_ = static_cast<float>(most_radius);
  radius_px_ = 0;
  pixels_.clear();
  hollow_.clear();
  smooth(depth, silhouette);
  ChordTest test;
  test.half_px_at_1m = kHalfChord * radius_ * fx_px_;
  test.nearest_at_1m = test.half_px_at_1m;
  test.least_half_px = kLeastHalfChord;
  test.fx_px = fx_px_;
  test.eight_radii = 8 * radius_;
  std::array<float, kChunk> may_be_hollow;
  for (int y = kRim; y < box_.height - kRim; ++y) {
    const auto [begin, end] = silhouette.things_of_row(box_.y + y);
    const int last = std::min(box_.width - kRim, end - box_.x);
    test.above = y;
    test.below = box_.height - 1 - y;
    for (int first = std::max(kRim, begin - box_.x); first < last; first += kChunk) {
      const int count = std::min(kChunk, last - first);
      test.before = first;
      test.after = box_.width - first - count;
      best_pixel_kernels().find_hollow(&mean_[index(first, y)], silhouette.row(box_.y + y) + first,
                                       box_.width, count, test, may_be_hollow.data());
      for (int k = 0; k < count; ++k) {
        if (may_be_hollow[static_cast<std::size_t>(k)] > 0) measure_sag(first + k, y);
      }
    }
  }
  for (const std::size_t at : hollow_) {
    if (!places_[at].gathered) gather(at);
  }
  const auto width = static_cast<std::size_t>(box_.width);
  for (const std::size_t at : hollow_) {
    if (!places_[at].is_middle) continue;
    const int x = static_cast<int>(at % width), y = static_cast<int>(at / width);
    radius_px_ = std::max(radius_px_, px_at(radius_, mean_[at]));
    const Vector2f n = across(x, y);
    pixels_.push_back({static_cast<std::int16_t>(box_.x + x),
                       static_cast<std::int16_t>(box_.y + y),
                       n,
                       {hidden_px(silhouette, x, y, -n), hidden_px(silhouette, x, y, n)}});
  }
  for (const std::size_t at : hollow_) places_[at] = {};
}

}  // namespace palpable
