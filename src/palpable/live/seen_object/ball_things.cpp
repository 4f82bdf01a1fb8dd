#include "palpable/live/seen_object/ball_things.h"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace palpable {
namespace {

using Eigen::Vector3f;

constexpr std::size_t kMostCompared = 256;     // balls
constexpr std::size_t kThingsBallRoom = 8192;  // balls, as ObjectSurface
constexpr float kJoined = 0.004f;              // m: balls that are so near each other are joined

// m, between the surfaces of two balls; negative if they overlap.
float gap_between(const ObjectBall& a, const ObjectBall& b) {
  return (a.centre - b.centre).norm() - a.radius - b.radius;
}

}  // namespace

BallThings::BallThings() {
  for (auto* list : {&chosen_, &parents_, &numbers_, &counts_}) list->reserve(kMostCompared);
  of_balls_.reserve(kThingsBallRoom);
  centres_.reserve(kMostCompared);
}

void BallThings::find(std::span<const ObjectBall> balls) {
  join_chosen(balls);
  of_balls_.clear();
  for (const ObjectBall& ball : balls) {
    float nearest = std::numeric_limits<float>::infinity();
    int found = 0;
    for (std::size_t c = 0; c < chosen_.size(); ++c) {
      const float gap = gap_between(ball, balls[static_cast<std::size_t>(chosen_[c])]);
      if (gap < nearest) nearest = gap, found = numbers_[c];
      if (gap < kJoined) break;  // all that are joined with it are of one thing
    }
    of_balls_.push_back(found);
  }
  find_centres(balls);
}

int BallThings::root_of(int chosen) const {
  while (parents_[static_cast<std::size_t>(chosen)] != chosen) {
    chosen = parents_[static_cast<std::size_t>(chosen)];
  }
  return chosen;
}

// Chooses balls, joins them, and numbers the things in the order of their first balls.
void BallThings::join_chosen(std::span<const ObjectBall> balls) {
  const std::size_t stride = (balls.size() + kMostCompared - 1) / kMostCompared;
  chosen_.clear(), parents_.clear(), numbers_.clear();
  for (std::size_t k = 0; k < balls.size(); k += stride) chosen_.push_back(static_cast<int>(k));
  for (int i = 0; i < std::ssize(chosen_); ++i) {
    parents_.push_back(i);
    const ObjectBall& ball = balls[static_cast<std::size_t>(chosen_[static_cast<std::size_t>(i)])];
    for (int j = 0; j < i; ++j) {
      const int other = chosen_[static_cast<std::size_t>(j)];
      if (gap_between(ball, balls[static_cast<std::size_t>(other)]) > kJoined) continue;
      const int a = root_of(i), b = root_of(j);
      parents_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  }
  int count = 0;
  for (int i = 0; i < std::ssize(chosen_); ++i) {
    const int root = root_of(i);
    numbers_.push_back(root == i ? count++ : numbers_[static_cast<std::size_t>(root)]);
  }
  centres_.assign(static_cast<std::size_t>(count), Vector3f::Zero());
}

void BallThings::find_centres(std::span<const ObjectBall> balls) {
  counts_.assign(centres_.size(), 0);
  for (std::size_t k = 0; k < balls.size(); ++k) {
    const auto thing = static_cast<std::size_t>(of_balls_[k]);
    centres_[thing] += balls[k].centre;
    ++counts_[thing];
  }
  for (std::size_t t = 0; t < centres_.size(); ++t) {
    centres_[t] /= static_cast<float>(std::max(counts_[t], 1));
  }
}

}  // namespace palpable
