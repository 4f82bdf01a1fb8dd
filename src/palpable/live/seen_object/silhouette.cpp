#include "palpable/live/seen_object/silhouette.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace palpable {
namespace {

constexpr float kNoDistance = std::numeric_limits<float>::infinity();

constexpr float kLeast = 0.01f;  // px, the least distance in a thing; 0 means no thing
constexpr int kBarred = 3;       // px, the largest width of a crease

// px added to the distance from a slanted outline of which only a mask of whole pixels is known.
// Such an outline is a staircase, and its nearest step lies nearer than the outline itself: without
// this, things would be too thin. Mean over slopes of 0 to 45 degrees and distances of 2 to 12 px.
constexpr float kBeyondSteps = 0.15f;

// The offset of (x, y) px, rounded to 1/16 px.
ToOutline outline_at(float x, float y) {
  return {static_cast<std::int16_t>(std::lround(x * kOutlineUnits)),
          static_cast<std::int16_t>(std::lround(y * kOutlineUnits))};
}

// Offers pixel x of a row the outline that is nearest to its neighbour at dx.
template <int dx>
inline void take_over(const OutlineRow& row, int x, const DepthJump& jump) {
  const float mine = row.distance[x], theirs = row.distance[x + dx];
  // One of the two shows no thing, or the neighbour's outline cannot be nearer than the present
  // one; also if neither has an outline (infinity - kOutlineStep >= infinity).
  if (!(mine > 0) || !(theirs > 0) || theirs - kOutlineStep >= mine) return;
  const ToOutline there = row.nearest[x + dx];
  // The neighbour's outline lies on its far side: it is farther from here than from there.
  if (theirs >= mine && there.dx * dx >= 0) return;
  constexpr int kStep = dx * static_cast<int>(kOutlineUnits);
  const ToOutline offer{static_cast<std::int16_t>(there.dx + kStep), there.dy};
  const float beyond = row.beyond[x + dx];
  const float length = length_of(offer) + beyond;
  if (!(length < mine)) return;
  const float z = row.depth[x], other = row.depth[x + dx], nearer = std::min(z, other);
  if (!(std::abs(z - other) <= std::max(jump.least, jump.at_1m * nearer * nearer))) return;
  row.distance[x] = length;
  row.nearest[x] = offer;
  row.beyond[x] = beyond;
}

}  // namespace

float depth_jump(const SilhouetteSettings& settings, float z) {
  return std::max(static_cast<float>(settings.least_jump),
                  static_cast<float>(settings.largest_jump_at_1m) * z * z);
}

bool Silhouette::joined(float z, float other) const {
  return std::abs(z - other) <= jump(std::min(z, other));
}

// Whether the thing at pixel (x, y) ends there in direction (dx, dy).
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
    // At the same depth: the thing continues, unless that pixel shows the room (a hand on a desk).
    return !shows_->empty() && shows_room((*shows_)(u, v));
  }
  return true;  // a wide hole: nothing was measured beside the thing
}

// First step of a row: finds its run of pixels that show things, and sets the distance of pixels
// beside which a thing ends (left, right, above or below). The sweeps propagate these distances.
void Silhouette::begin_row(int y) {
  const int right = box_.x + box_.width;
  const float* depth = depth_->row(y);
  const std::uint8_t* shows = shows_->empty() ? nullptr : shows_->row(y);
  int begin = box_.x, end = right;
  if (shows != nullptr) {
    while (begin < end && shows[begin] != kShowsPresser) ++begin;
    while (begin < end && shows[end - 1] != kShowsPresser) --end;
  }
  runs_[static_cast<std::size_t>(y - box_.y)] = {begin, end};
  const std::size_t first = at(begin, y), count = static_cast<std::size_t>(end - begin);
  std::copy_n(depth + begin, count, depths_.data() + first);
  std::fill_n(beyond_.data() + first, count, 0.0f);
  const bool is_first = y == 0, is_last = y + 1 == depth_->height();
  const auto least = static_cast<float>(settings_.least_jump);
  for (int x = begin; x < end; ++x) {
    const float z = depth[x];
    if (!is_depth(z) || (shows != nullptr && shows[x] != kShowsPresser)) continue;
    // A quick test for the interior of a thing, where most pixels lie.
    if (shows != nullptr && !is_first && !is_last && x > 0 && x + 1 < depth_->width()) {
      const auto width = static_cast<std::ptrdiff_t>(depth_->width());
      const int apart = static_cast<int>(!(std::abs(depth[x - 1] - z) < least)) |
                        static_cast<int>(!(std::abs(depth[x + 1] - z) < least)) |
                        static_cast<int>(!(std::abs(depth[x - width] - z) < least)) |
                        static_cast<int>(!(std::abs(depth[x + width] - z) < least));
      const int shown = shows[x - 1] & shows[x + 1] & shows[x - width] & shows[x + width];
      if (apart == 0 && shown == kShowsPresser) {
        distance_[at(x, y)] = kNoDistance;
        continue;
      }
    }
    begin_at(x, y);
  }
}

// px by which an outline is moved outwards whose first pixel beyond it is (x, y): see
// SilhouetteSettings::beside_unknown.
float Silhouette::known_better(int x, int y) const {
  const std::uint8_t shows = shows_->empty() ? kShowsRoom : (*shows_)(x, y);
  if (shows == kShowsRoomByEdge) return static_cast<float>(settings_.by_edge);
  if (shows == kShowsRoomByColor) return static_cast<float>(settings_.by_color);
  const bool unknown = shows == kShowsUnknown || !is_depth((*depth_)(x, y));
  return unknown ? static_cast<float>(settings_.beside_unknown) : 0;
}

// Whether the outline between pixel (x, y) and its neighbour at (dx, dy) follows the border of the
// pixels on both sides of them, too: then it is no step of a slanted outline.
bool Silhouette::is_straight(int x, int y, int dx, int dy) const {
  const auto is_thing = [&](int u, int v) {
    if (u < 0 || v < 0 || u >= depth_->width() || v >= depth_->height()) return false;
    return is_depth((*depth_)(u, v)) && (shows_->empty() || (*shows_)(u, v) == kShowsPresser) &&
           joined((*depth_)(u, v), (*depth_)(x, y));
  };
  return is_thing(x + dy, y + dx) && is_thing(x - dy, y - dx) &&
         !is_thing(x + dx + dy, y + dy + dx) && !is_thing(x + dx - dy, y + dy - dx);
}

// Finds the nearest outline between a pixel of a thing and its four neighbours.
void Silhouette::begin_at(int x, int y) {
  float& distance = distance_[at(x, y)];
  distance = kNoDistance;
  const float z = (*depth_)(x, y), least = static_cast<float>(settings_.least_jump);
  for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
    const int u = x + dx, v = y + dy;
    const bool inside = u >= 0 && v >= 0 && u < depth_->width() && v < depth_->height();
    if (inside && std::abs((*depth_)(u, v) - z) < least &&
        (shows_->empty() || (*shows_)(u, v) == kShowsPresser)) {
      continue;
    }
    if (!ends_towards(x, y, dx, dy)) continue;
    // px from the middle of this pixel towards its neighbour's, to where the covered share is 1/2.
    float way = 0.5f, beyond = 0;
    if (inside) {
      beyond = known_better(u, v);
      const float covered = presence_ != nullptr ? (*presence_)(x, y) : 1;
      const float beside = presence_ != nullptr ? (*presence_)(u, v) : 0;
      way = std::max(covered + beside - 0.5f, 0.0f);
      if (covered == 1 && beside == 0 && !is_straight(x, y, dx, dy)) beyond += kBeyondSteps;
    }
    if (way + beyond >= distance) continue;
    distance = std::max(way + beyond, kLeast);
    nearest_[at(x, y)] = outline_at(way * static_cast<float>(dx), way * static_cast<float>(dy));
    beyond_[at(x, y)] = beyond;
  }
}

OutlineRow Silhouette::outline_row(int x, int y) {
  const std::size_t n = at(x, y);
  return {&distance_[n], &nearest_[n], &beyond_[n], &depths_[n]};
}

// Propagates outlines by two sweeps, down and up: each pixel of `box` takes over an outline of its
// neighbours if that is nearer than its own.
void Silhouette::propagate(const PixelBox& box) {
  const PixelKernels& kernels = best_pixel_kernels();
  const auto sweep = [&](int y, int dy) {
    const Run run = things_of_row(y);
    const int left = std::max(box.x, run.begin), right = std::min(box.x + box.width, run.end);
    if (left >= right) return;
    if (y + dy >= box_.y && y + dy < box_.y + box_.height) {
      kernels.take_over(outline_row(left, y + dy), outline_row(left, y), dy, right - left, jump_);
    }
    const OutlineRow row = outline_row(left, y);
    for (int x = 0; x < right - left; ++x) take_over<-1>(row, x, jump_);
    for (int x = right - left - 1; x >= 0; --x) take_over<1>(row, x, jump_);
  };
  for (int y = box.y; y < box.y + box.height; ++y) sweep(y, -1);
  for (int y = box.y + box.height - 1; y >= box.y; --y) sweep(y, 1);
}

// Marks a pixel so that no outline is propagated across it.
void Silhouette::bar(int x, int y) {
  if (!(distance_[at(x, y)] > 0)) return;
  distance_[at(x, y)] = kLeast;
  nearest_[at(x, y)] = {};
  beyond_[at(x, y)] = kNoDistance;
}

// Sets the outline of a crease at the first pixel on the side `away` that is not barred.
// @param hidden  px by which the thing on that side continues behind the other one
void Silhouette::begin_beside(const CreasePixel& crease, const Eigen::Vector2f& away,
                              float hidden) {
  for (int k = 1; k <= kBarred; ++k) {
    const auto dx = static_cast<int>(std::lround(static_cast<float>(k) * away.x()));
    const auto dy = static_cast<int>(std::lround(static_cast<float>(k) * away.y()));
    const int x = crease.x + dx, y = crease.y + dy;
    if (x < box_.x || y < box_.y || x >= box_.x + box_.width || y >= box_.y + box_.height) return;
    const std::size_t n = at(x, y);
    if (distance_[n] > 0 && beyond_[n] == kNoDistance) continue;  // barred
    const float length =
        static_cast<float>(dx) * away.x() + static_cast<float>(dy) * away.y() + hidden;
    if (!(distance_[n] > length)) return;
    distance_[n] = length;
    nearest_[n] = outline_at(static_cast<float>(-dx), static_cast<float>(-dy));
    beyond_[n] = length - length_of(nearest_[n]);
    return;
  }
}

void Silhouette::part(std::span<const CreasePixel> creases, int reach) {
  if (creases.empty()) return;
  // The pixel below is barred as well, so that a slanted line has no diagonal gaps.
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
  propagate({left, top, right - left + 1, bottom - top + 1});
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
  // Reserved for the whole image: the next box may be larger.
  constexpr std::size_t kBesideBox = kBefore + kReadBeyond;
  const std::size_t most = (static_cast<std::size_t>(depth.width()) + kBesideBox) *
                           (static_cast<std::size_t>(depth.height()) + 2);
  for (std::vector<float>* values : {&distance_, &beyond_, &depths_}) values->reserve(most);
  nearest_.reserve(most);
  runs_.reserve(static_cast<std::size_t>(depth.height()));
  stride_ = static_cast<std::size_t>(box.width) + kBesideBox;
  const std::size_t count = stride_ * (static_cast<std::size_t>(box.height) + 2);
  distance_.assign(count, 0.0f);
  for (std::vector<float>* values : {&beyond_, &depths_}) values->resize(count);
  nearest_.resize(count);
  runs_.resize(static_cast<std::size_t>(box.height));
  for (int y = box.y; y < box.y + box.height; ++y) begin_row(y);
  propagate(box);
  depth_ = nullptr;
  shows_ = nullptr;
  presence_ = nullptr;
}

}  // namespace palpable
