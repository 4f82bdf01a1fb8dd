#include "palpable/live/map/tile_groups.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <hwy/base.h>

namespace palpable {
namespace {

// If at least this share of a group's tiles moves by evidence of this frame, the ages of its tiles
// are reset to 0. Otherwise the ages grow, so that a group cannot keep itself moving for ever.
constexpr double kEvident = 0.1;

constexpr std::uint8_t kLongAgo = 127;      // the largest age
constexpr std::uint8_t kOfThisFrame = 128;  // added to the ages that this frame has written

// State of a tile in this frame: kDone belongs to a group or needs none, kMayJoin is unexplained,
// kWaits will be part of a group.
enum State : std::uint8_t { kDone, kMayJoin, kWaits };

// Labels from `waits` on become kWaits, others from `may_join` on kMayJoin, the rest kDone.
// HWY_RESTRICT declares that the arrays do not overlap, which the compiler cannot infer for
// members. It can then vectorise the loop.
void set_states(const std::uint8_t* label, std::uint8_t may_join, std::uint8_t waits,
                std::uint8_t* HWY_RESTRICT state, std::size_t count) {
  static_assert(kDone == 0 && kMayJoin == 1 && kWaits == 2);
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint8_t joins = label[k] >= may_join ? 1 : 0, stands = label[k] >= waits ? 1 : 0;
    state[k] = static_cast<std::uint8_t>(joins + stands);
  }
}

// Calls visit(i, j, state) with a tile and its up to eight neighbours.
template <typename Visit>
void for_around(Image<std::uint8_t>& state, int i, int j, const Visit& visit) {
  for (int y = std::max(j - 1, 0); y <= std::min(j + 1, state.height() - 1); ++y) {
    for (int x = std::max(i - 1, 0); x <= std::min(i + 1, state.width() - 1); ++x) {
      visit(x, y, state(x, y));
    }
  }
}

}  // namespace

TileGroups::TileGroups(const TileGroupSettings& settings) : settings_(settings) {
  PALPABLE_EXPECT(settings.same_share > 0, "a tolerance is not negative");
  PALPABLE_EXPECT(settings.fewest_tiles >= 0 && settings.frames_to_carry >= 0 &&
                      settings.frames_to_carry < kLongAgo,
                  "a margin is not negative");
}

void TileGroups::resize(int width, int height) {
  state_ = Image<std::uint8_t>(width, height);
  age_ = Image<std::uint8_t>(width, height, kLongAgo);
  moved_depth_ = DepthImage(width, height);
  group_.reserve(state_.size());
  edge_.reserve(state_.size());
}

TileGroups::Label TileGroups::label_of_unexplained(int i, int j, float depth) const {
  const float before = moved_depth_(i, j);
  const bool same = std::abs(depth - before) <= static_cast<float>(settings_.same_share) * before;
  return same && age_(i, j) < settings_.frames_to_carry ? kCarried : kUnexplained;
}

// Fills group_ with all waiting tiles that are connected to the first one, and edge_ with those of
// them that have an unexplained neighbour.
void TileGroups::gather_group(std::size_t first) {
  const auto add = [this](int i, int j) {
    state_(i, j) = kDone;
    group_.push_back({static_cast<std::int16_t>(i), static_cast<std::int16_t>(j)});
  };
  group_.clear();
  edge_.clear();
  const auto width = static_cast<std::size_t>(state_.width());
  add(static_cast<int>(first % width), static_cast<int>(first / width));
  for (std::size_t head = 0; head < group_.size(); ++head) {
    const Tile at = group_[head];
    bool on_edge = false;
    for_around(state_, at.i, at.j, [&](int i, int j, std::uint8_t state) {
      on_edge = on_edge || state == kMayJoin;
      if (state == kWaits) add(i, j);
    });
    if (on_edge) edge_.push_back(at);
  }
}

// Largest depth of a tile that may join, m: 1.1 (mean + 2 standard deviations) of the group's
// depths. NaN if no tile of the group has a depth.
float TileGroups::deepest_of_group(const DepthImage& depth) const {
  double sum = 0, squares = 0, known = 0;
  for (const Tile at : group_) {
    const auto Z = static_cast<double>(depth(at.i, at.j));
    if (std::isnan(Z)) continue;  // too close to be measured, or changed
    sum += Z;
    squares += Z * Z;
    known += 1;
  }
  const double mean = sum / std::max(known, 1.0);
  return static_cast<float>(1.1 *
                            (mean + 2 * std::sqrt(std::max(squares / known - mean * mean, 0.0))));
}

// Adds the unexplained tiles that continue the group's depth from its edge.
void TileGroups::add_unexplained(const DepthImage& depth) {
  const auto share = static_cast<float>(settings_.same_share);
  const float deepest = deepest_of_group(depth);
  const std::size_t joined = edge_.size();  // index of the first tile that joins
  for (std::size_t head = 0; head < edge_.size(); ++head) {
    const Tile at = edge_[head];
    const float from = depth(at.i, at.j);
    for_around(state_, at.i, at.j, [&](int i, int j, std::uint8_t& state) {
      if (state != kMayJoin) return;
      const float Z = depth(i, j);
      if (!(Z <= deepest && std::abs(from - Z) <= share * Z)) return;
      state = kDone;
      edge_.push_back({static_cast<std::int16_t>(i), static_cast<std::int16_t>(j)});
    });
  }
  const auto first = edge_.begin() + static_cast<std::ptrdiff_t>(joined);
  if (static_cast<double>(edge_.size() - joined) <=
      settings_.most_unexplained * static_cast<double>(group_.size())) {
    group_.insert(group_.end(), first, edge_.end());
  } else {
    // They may join another group.
    for (auto at = first; at != edge_.end(); ++at) state_(at->i, at->j) = kMayJoin;
  }
}

// @param is_evident  whether enough of the group moves by evidence of this frame (kEvident)
void TileGroups::mark_moving(const DepthImage& depth, bool is_evident, Image<std::uint8_t>& label) {
  for (const Tile at : group_) {
    std::uint8_t &age = age_(at.i, at.j), &of_tile = label(at.i, at.j);
    const bool is_young = is_evident && of_tile >= kChanged;
    age =
        static_cast<std::uint8_t>(kOfThisFrame + (is_young ? 0 : std::min<int>(age + 1, kLongAgo)));
    of_tile = kMoving;
    moved_depth_(at.i, at.j) = depth(at.i, at.j);
  }
}

bool TileGroups::find(const DepthImage& depth, Image<std::uint8_t>& label) {
  bool moved = false;
  set_states(label.data(), kUnexplained, kChanged, state_.data(), state_.size());
  std::size_t start = 0;
  while (const void* found = std::memchr(state_.data() + start, kWaits, state_.size() - start)) {
    start = static_cast<std::size_t>(static_cast<const std::uint8_t*>(found) - state_.data());
    gather_group(start);
    if (static_cast<int>(group_.size()) < settings_.fewest_tiles) {
      for (const Tile at : group_) label(at.i, at.j) = kStatic;
      continue;
    }
    moved = true;
    const auto evident = std::count_if(group_.begin(), group_.end(),
                                       [&](Tile at) { return label(at.i, at.j) != kCarried; });
    add_unexplained(depth);
    mark_moving(depth,
                static_cast<double>(evident) >= kEvident * static_cast<double>(group_.size()),
                label);
  }
  for (std::uint8_t& age : age_) {
    age = age >= kOfThisFrame ? static_cast<std::uint8_t>(age - kOfThisFrame) : kLongAgo;
  }
  return moved;
}

}  // namespace palpable
