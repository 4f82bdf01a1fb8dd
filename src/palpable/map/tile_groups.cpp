#include "palpable/map/tile_groups.h"

#include "palpable/base/contract.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <hwy/base.h>

namespace palpable {
namespace {

// A group of which this share is seen to move needs no memory of earlier frames.
constexpr double kEvident = 0.1;

constexpr std::uint8_t kLongAgo = 127;  // of an age
constexpr std::uint8_t kOfThisFrame = 128;

// Of a tile in this frame.
enum State : std::uint8_t { kDone, kMayJoin, kWaits };

// Each value is touched once, in arrays apart from each other, which the compiler cannot know of
// members: told so, it takes many at a time.
void tell_states(const std::uint8_t* label, std::uint8_t may_join, std::uint8_t waits,
                 std::uint8_t* HWY_RESTRICT state, std::size_t count) {
  static_assert(kDone == 0 && kMayJoin == 1 && kWaits == 2);
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint8_t joins = label[k] >= may_join ? 1 : 0, stands = label[k] >= waits ? 1 : 0;
    state[k] = static_cast<std::uint8_t>(joins + stands);
  }
}

// Calls `visit` with each tile around one, itself among them, and what is said of it.
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

TileGroups::Label TileGroups::unexplained(int i, int j, float depth) const {
  const float before = moved_depth_(i, j);
  const bool same = std::abs(depth - before) <= static_cast<float>(settings_.same_share) * before;
  return same && age_(i, j) < settings_.frames_to_carry ? kCarried : kUnexplained;
}

// All tiles that wait and hang together with one of them: group_; edge_: those at the group's edge.
void TileGroups::gather(std::size_t first) {
  const auto take = [this](int i, int j) {
    state_(i, j) = kDone;
    group_.push_back({static_cast<std::int16_t>(i), static_cast<std::int16_t>(j)});
  };
  group_.clear();
  edge_.clear();
  const auto width = static_cast<std::size_t>(state_.width());
  take(static_cast<int>(first % width), static_cast<int>(first / width));
  for (std::size_t head = 0; head < group_.size(); ++head) {
    const Tile at = group_[head];
    bool on_edge = false;
    for_around(state_, at.i, at.j, [&](int i, int j, std::uint8_t state) {
      on_edge = on_edge || state == kMayJoin;
      if (state == kWaits) take(i, j);
    });
    if (on_edge) edge_.push_back(at);
  }
}

// Two deviations beyond the mean, and a tenth; NaN where no tile of the group has a depth.
float TileGroups::deepest_of_group(const DepthImage& depth) const {
  double sum = 0, squares = 0, known = 0;
  for (const Tile at : group_) {
    const auto Z = static_cast<double>(depth(at.i, at.j));
    if (std::isnan(Z)) continue;  // too close
    sum += Z;
    squares += Z * Z;
    known += 1;
  }
  const double mean = sum / std::max(known, 1.0);
  return static_cast<float>(1.1 *
                            (mean + 2 * std::sqrt(std::max(squares / known - mean * mean, 0.0))));
}

// What is unexplained and continues the group from its edge.
void TileGroups::join(const DepthImage& depth) {
  const auto share = static_cast<float>(settings_.same_share);
  const float deepest = deepest_of_group(depth);
  const std::size_t joined = edge_.size();  // the first of them
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
    // Another group may take them.
    for (auto at = first; at != edge_.end(); ++at) state_(at->i, at->j) = kMayJoin;
  }
}

bool TileGroups::find(const DepthImage& depth, Image<std::uint8_t>& label) {
  bool moved = false;
  tell_states(label.data(), kUnexplained, kChanged, state_.data(), state_.size());
  std::size_t start = 0;
  while (const void* found = std::memchr(state_.data() + start, kWaits, state_.size() - start)) {
    start = static_cast<std::size_t>(static_cast<const std::uint8_t*>(found) - state_.data());
    gather(start);
    if (static_cast<int>(group_.size()) < settings_.fewest_tiles) {
      for (const Tile at : group_) label(at.i, at.j) = kStatic;
      continue;
    }
    moved = true;
    const auto evident = std::count_if(group_.begin(), group_.end(),
                                       [&](Tile at) { return label(at.i, at.j) != kCarried; });
    join(depth);
    const bool sure = static_cast<double>(evident) >= kEvident * static_cast<double>(group_.size());
    for (const Tile at : group_) {
      std::uint8_t &age = age_(at.i, at.j), &of_tile = label(at.i, at.j);
      const bool fresh = sure && of_tile >= kChanged;
      age =
          static_cast<std::uint8_t>(kOfThisFrame + (fresh ? 0 : std::min<int>(age + 1, kLongAgo)));
      of_tile = kMoving;
      moved_depth_(at.i, at.j) = depth(at.i, at.j);
    }
  }
  for (std::uint8_t& age : age_) {
    age = age >= kOfThisFrame ? static_cast<std::uint8_t>(age - kOfThisFrame) : kLongAgo;
  }
  return moved;
}

}  // namespace palpable
