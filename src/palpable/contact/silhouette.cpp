#include "palpable/contact/silhouette.h"

#include "palpable/base/contract.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace palpable {
namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();

constexpr float kLeast = 0.01f;  // px: 0 would say that there is no thing
constexpr float kStep = 1.7f;    // px by which neighbouring distances differ at most
constexpr int kBarred = 3;       // px: no crease is wider

bool is_depth(float z) { return std::isfinite(z) && z > 0.0f; }

// The outline runs before the middle of the first pixel beyond it: half a pixel, where it runs
// along rows or columns. A slanted one passes nearer to the nearest of the many pixels beside it;
// 0.28 px is the mean over all slopes.
float length_of(ToOutline d) {
  const bool slanted = d.dx != 0 && d.dy != 0;
  return std::sqrt(static_cast<float>(d.dx * d.dx + d.dy * d.dy)) - (slanted ? 0.28f : 0.5f);
}

}  // namespace

float depth_jump(const SilhouetteSettings& settings, float z) {
  return std::max(static_cast<float>(settings.least_jump),
                  static_cast<float>(settings.largest_jump_at_1m) * z * z);
}

bool Silhouette::joined(float z, float other) const {
  return std::abs(z - other) <= jump(std::min(z, other));
}

// Whether the thing that pixel (x, y) shows ends there, seen in direction (dx, dy).
bool Silhouette::ends_towards(int x, int y, int dx, int dy) const {
  const DepthImage& depth = *depth_;
  const float z = depth(x, y);
  for (int k = 1; k <= settings_.longest_hole; ++k) {
    const int u = x + k * dx, v = y + k * dy;
    if (u < 0 || v < 0 || u >= depth.width() || v >= depth.height()) return k > 1;
    const float other = depth(u, v);
    if (!is_depth(other)) continue;
    if (other < z - jump(other)) return false;  // something nearer hides the rest
    if (other > z + jump(z)) return true;
    // As near: the thing goes on, unless that is the desk on which a hand lies.
    return !shows_->empty() && (*shows_)(u, v) == kShowsRoom;
  }
  return true;  // a wide hole: nothing was measured beside the thing
}

// Offers pixel `here` of the box, of depth z, the outline that is nearest to pixel `other`, its
// neighbour at (dx, dy), of depth z_other.
void Silhouette::take_over(std::size_t here, std::size_t other, int dx, int dy, float z,
                           float z_other) {
  const float theirs = distance_[other];
  // No thing is there, or its outline is too far away to matter here; both where it has none.
  if (!(theirs > 0) || theirs - kStep >= distance_[here]) return;
  const ToOutline there = nearest_[other];
  const ToOutline offer{static_cast<std::int16_t>(there.dx + dx),
                        static_cast<std::int16_t>(there.dy + dy)};
  const float beyond = beyond_[other];
  const float length = length_of(offer) + beyond;
  if (!(length < distance_[here]) || !joined(z, z_other)) return;
  distance_[here] = length;
  nearest_[here] = offer;
  beyond_[here] = beyond;
}

// The outlines that pass right beside a pixel of a thing.
void Silhouette::begin_at(int x, int y) {
  float& distance = distance_[at(x, y)];
  distance = kInfinite;
  const float z = (*depth_)(x, y), least = static_cast<float>(settings_.least_jump);
  for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
    const int u = x + dx, v = y + dy;
    const bool inside = u >= 0 && v >= 0 && u < depth_->width() && v < depth_->height();
    // Most pixels lie amid a thing.
    if (inside && std::abs((*depth_)(u, v) - z) < least &&
        (shows_->empty() || (*shows_)(u, v) == kShowsPresser)) {
      continue;
    }
    if (!ends_towards(x, y, dx, dy)) continue;
    const float beyond =
        presence_ == nullptr || !inside ? 0 : (*presence_)(u, v) + (*presence_)(x, y) - 1;
    if (0.5f + beyond >= distance) continue;
    distance = std::max(0.5f + beyond, kLeast);
    nearest_[at(x, y)] = {static_cast<std::int16_t>(dx), static_cast<std::int16_t>(dy)};
    beyond_[at(x, y)] = beyond;
  }
}

// Two sweeps, down and up: each pixel of `box` takes over the outlines that its neighbours know.
void Silhouette::hand_on(const PixelBox& box) {
  const int left = box.x, right = box.x + box.width, bottom = box.y + box.height;
  const int first = box_.x, last = box_.x + box_.width - 1;
  const auto sweep = [&](int y, int dy) {
    const float* depth = depth_->row(y);
    const std::size_t row = at(first, y) - static_cast<std::size_t>(first);
    const bool has_next = y + dy >= box_.y && y + dy < box_.y + box_.height;
    const float* next_depth = has_next ? depth_->row(y + dy) : depth;
    const std::size_t next = has_next ? at(first, y + dy) - static_cast<std::size_t>(first) : row;
    for (int x = left; x < right; ++x) {
      const std::size_t here = row + static_cast<std::size_t>(x);
      if (!(distance_[here] > 0)) continue;
      const float z = depth[x];
      if (has_next) {
        for (int u = std::max(x - 1, first); u <= std::min(x + 1, last); ++u) {
          take_over(here, next + static_cast<std::size_t>(u), u - x, dy, z, next_depth[u]);
        }
      }
      if (x > first) take_over(here, here - 1, -1, 0, z, depth[x - 1]);
    }
    for (int x = right - 1; x >= left; --x) {
      const std::size_t here = row + static_cast<std::size_t>(x);
      if (x < last && distance_[here] > 0) take_over(here, here + 1, 1, 0, depth[x], depth[x + 1]);
    }
  };
  for (int y = box.y; y < bottom; ++y) sweep(y, -1);
  for (int y = bottom - 1; y >= box.y; --y) sweep(y, 1);
}

// No outline is handed on over this pixel.
void Silhouette::bar(int x, int y) {
  if (!(distance_[at(x, y)] > 0)) return;
  distance_[at(x, y)] = kLeast;
  nearest_[at(x, y)] = {};
  beyond_[at(x, y)] = kInfinite;
}

// The first pixel beside a crease that is not barred.
void Silhouette::begin_beside(const CreasePixel& crease, const Eigen::Vector2f& away,
                              float hidden) {
  for (int k = 1; k <= kBarred; ++k) {
    const auto dx = static_cast<int>(std::lround(static_cast<float>(k) * away.x()));
    const auto dy = static_cast<int>(std::lround(static_cast<float>(k) * away.y()));
    const int x = crease.x + dx, y = crease.y + dy;
    if (x < box_.x || y < box_.y || x >= box_.x + box_.width || y >= box_.y + box_.height) return;
    const std::size_t n = at(x, y);
    if (beyond_[n] == kInfinite) continue;
    const float length =
        static_cast<float>(dx) * away.x() + static_cast<float>(dy) * away.y() + hidden;
    if (!(distance_[n] > length)) return;
    distance_[n] = length;
    nearest_[n] = {static_cast<std::int16_t>(-dx), static_cast<std::int16_t>(-dy)};
    beyond_[n] = length - length_of(nearest_[n]);
    return;
  }
}

void Silhouette::part(const DepthImage& depth, std::span<const CreasePixel> creases, int reach) {
  if (creases.empty()) return;
  // A slanted line of pixels is tight where each has one below it.
  int left = creases[0].x, right = left, top = creases[0].y, bottom = top;
  for (const CreasePixel& crease : creases) {
    bar(crease.x, crease.y);
    bar(crease.x, crease.y + 1);
    left = std::min<int>(left, crease.x), right = std::max<int>(right, crease.x);
    top = std::min<int>(top, crease.y), bottom = std::max<int>(bottom, crease.y);
  }
  for (const CreasePixel& crease : creases) {
    const auto& [before, after] = crease.hidden;
    if (before) begin_beside(crease, -crease.across, *before);
    if (after) begin_beside(crease, crease.across, *after);
  }
  left = std::max(left - reach, box_.x), right = std::min(right + reach, box_.x + box_.width - 1);
  top = std::max(top - reach, box_.y), bottom = std::min(bottom + reach, box_.y + box_.height - 1);
  depth_ = &depth;
  hand_on({left, top, right - left + 1, bottom - top + 1});
  depth_ = nullptr;
}

void Silhouette::find(const DepthImage& depth, const MaskImage& shows, const PixelBox& box,
                      const Image<float>* presence) {
  PALPABLE_EXPECT(box.x >= 0 && box.y >= 0 && box.x + box.width <= depth.width() &&
                      box.y + box.height <= depth.height(),
                  "the box lies inside the image");
  PALPABLE_EXPECT(
      shows.empty() || (shows.width() == depth.width() && shows.height() == depth.height()),
      "the mask is of the depth's size");
  box_ = box;
  depth_ = &depth;
  shows_ = &shows;
  presence_ = presence;
  const std::size_t count =
      static_cast<std::size_t>(box.width) * static_cast<std::size_t>(box.height);
  // The next box may be larger.
  for (std::vector<float>* values : {&distance_, &beyond_}) values->reserve(depth.size());
  nearest_.reserve(depth.size());
  distance_.assign(count, 0.0f);
  nearest_.resize(count);
  beyond_.assign(count, 0.0f);
  const int right = box.x + box.width, bottom = box.y + box.height;
  for (int y = box.y; y < bottom; ++y) {
    for (int x = box.x; x < right; ++x) {
      if (!is_depth(depth(x, y)) || (!shows.empty() && shows(x, y) != kShowsPresser)) { continue; }
      begin_at(x, y);
    }
  }
  hand_on(box);
  depth_ = nullptr;
  shows_ = nullptr;
  presence_ = nullptr;
}

}  // namespace palpable
