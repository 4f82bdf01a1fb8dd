#include "palpable/live/seen_object/ball_tree.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>

namespace palpable {
namespace {

using Eigen::Vector3f;

// Size of the stack of a walk: dividing 2^31 balls by four down to blocks takes fewer than 16
// levels, and each level leaves up to three boxes on the stack.
constexpr std::size_t kMostWaiting = 64;
// m: bound of the difference of two roundings of one distance.
constexpr float kRounding = 1e-7f;
constexpr float kInfinite = std::numeric_limits<float>::infinity();

// The square roots of floats, rounded correctly. Eigen's own are made of the processor's
// approximate reciprocal root, which differs from maker to maker, and a run must give the same
// bytes on each.
template <class Squares>
[[nodiscard]] typename Squares::PlainObject root_of(const Squares& squares) {
  return squares.template cast<double>().sqrt().template cast<float>();
}

}  // namespace

BallTree::Block BallTree::Balls::distances(const Vector3f& from) const {
  return root_of((x - from.x()).square() + (y - from.y()).square() + (z - from.z()).square()) -
         radius;
}

// Halves a range of order_ across the longest side of its box. The first half consists of full
// blocks. @return the index at which the second half begins
int BallTree::split(int begin, int end) {
  if (end - begin <= kBlock) return end;
  Eigen::AlignedBox3f box;
  for (int k = begin; k < end; ++k) box.extend(balls_[order_[k]].centre);
  Vector3f::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const int blocks = (end - begin + kBlock - 1) / kBlock;
  const int middle = begin + (blocks + 1) / 2 * kBlock;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](int a, int b) {
                     const float xa = balls_[a].centre[axis], xb = balls_[b].centre[axis];
                     return xa != xb ? xa < xb : a < b;
                   });
  return middle;
}

void BallTree::set_child(int node, int slot, int begin, int end) {
  if (begin == end) return;
  Eigen::AlignedBox3f box;
  float largest = 0;
  for (int k = begin; k < end; ++k) {
    const Ball& ball = balls_[order_[k]];
    box.extend(ball.centre);
    largest = std::max(largest, ball.radius);
  }
  const int child = end - begin <= kBlock ? ~(begin / kBlock) : add(begin, end);
  const Vector3f middle = box.center(), half = box.sizes() / 2;
  Node& n = nodes_[node];
  n.x[slot] = middle.x(), n.y[slot] = middle.y(), n.z[slot] = middle.z();
  n.half_x[slot] = half.x(), n.half_y[slot] = half.y(), n.half_z[slot] = half.z();
  n.radius[slot] = largest;
  n.child[static_cast<std::size_t>(slot)] = child;
}

int BallTree::add(int begin, int end) {
  const int index = static_cast<int>(nodes_.size());
  Node& node = nodes_.emplace_back();
  for (auto* of : {&node.x, &node.y, &node.z, &node.half_x, &node.half_y, &node.half_z})
    of->setZero();
  node.radius.setConstant(-kInfinite);
  const int middle = split(begin, end);
  const int first = split(begin, middle), last = split(middle, end);
  set_child(index, 0, begin, first);
  set_child(index, 1, first, middle);
  set_child(index, 2, middle, last);
  set_child(index, 3, last, end);
  return index;
}

void BallTree::reserve(std::size_t balls) {
  balls_.reserve(balls);
  order_.reserve(balls);
  blocks_.reserve(balls / kBlock + 1);
  nodes_.reserve(balls / kBlock + 1);  // each node has two children or more, unless it is the root
}

void BallTree::build(std::span<const Ball> balls) {
  balls_.assign(balls.begin(), balls.end());
  order_.resize(balls.size());
  std::iota(order_.begin(), order_.end(), 0);
  nodes_.clear();
  if (!balls.empty()) add(0, static_cast<int>(balls.size()));
  blocks_.resize((balls.size() + kBlock - 1) / kBlock);
  for (std::size_t k = 0; k < kBlock * blocks_.size(); ++k) {
    Balls& block = blocks_[k / kBlock];
    const auto i = static_cast<Eigen::Index>(k % kBlock);
    const Ball ball = k < order_.size() ? balls_[order_[k]] : Ball{Vector3f::Zero(), -kInfinite};
    block.x[i] = ball.centre.x(), block.y[i] = ball.centre.y(), block.z[i] = ball.centre.z();
    block.radius[i] = ball.radius;
  }
}

// Calls at_block() for every block with a ball that may be nearer to x than `reach`, in order of
// the boxes' distances within each node. `reach` is a reference: at_block() lowers it as it finds
// balls.
template <class AtBlock>
void BallTree::walk(const Vector3f& x, const float& reach, const AtBlock& at_block) const {
  if (nodes_.empty()) return;
  struct Waiting {
    int child;
    float least;  // m, lower bound of the distances of its balls
  };
  std::array<Waiting, kMostWaiting> stack;
  std::size_t waiting = 0;
  stack[waiting++] = {0, -kInfinite};
  while (waiting > 0) {
    const Waiting next = stack[--waiting];
    if (next.least >= reach) continue;
    if (next.child < 0) {
      const int block = ~next.child;
      at_block(static_cast<std::size_t>(block));
      continue;
    }
    const Node& n = nodes_[next.child];
    const Eigen::Array4f dx = ((n.x - x.x()).abs() - n.half_x).max(0.0f);
    const Eigen::Array4f dy = ((n.y - x.y()).abs() - n.half_y).max(0.0f);
    const Eigen::Array4f dz = ((n.z - x.z()).abs() - n.half_z).max(0.0f);
    const Eigen::Array4f least = root_of(dx.square() + dy.square() + dz.square()) - n.radius;
    // Sorted, with the nearest one on top of the stack.
    const std::size_t bottom = waiting;
    for (int k = 0; k < 4; ++k) {
      if (!(least[k] < reach)) continue;
      std::size_t at = waiting++;
      for (; at > bottom && stack[at - 1].least < least[k]; --at) stack[at] = stack[at - 1];
      stack[at] = {n.child[static_cast<std::size_t>(k)], least[k]};
    }
  }
}

std::optional<NearestBall> BallTree::nearest(const Vector3f& x, float reach) const {
  float best = reach;
  int found = -1;
  walk(x, best, [&](std::size_t block) {
    const Block roughly = blocks_[block].distances(x);
    for (Eigen::Index k = 0; k < kBlock; ++k) {
      if (!(roughly[k] < best + kRounding)) continue;
      const int index = order_[block * kBlock + static_cast<std::size_t>(k)];
      const Ball& ball = balls_[static_cast<std::size_t>(index)];
      const float distance = (ball.centre - x).norm() - ball.radius;
      if (!(distance < best)) continue;
      best = distance;
      found = index;
    }
  });
  if (found < 0) return std::nullopt;
  return NearestBall{best, found};
}

bool BallTree::is_any_within(const Vector3f& x, float reach) const {
  float wanted = reach;
  walk(x, wanted, [&](std::size_t block) {
    if (blocks_[block].distances(x).minCoeff() < reach) wanted = -kInfinite;
  });
  return wanted < reach;
}

// With a ball's centre at x + out across + beside t, t a unit vector perpendicular to `across`, no
// position of the circle is nearer to that centre than sqrt(out^2 + (beside - spread)^2). This
// bound excludes most balls.
std::array<float, 8> BallTree::distances_around(const Vector3f& x, const Vector3f& across,
                                                float spread, std::span<const Vector3f, 8> places,
                                                int ball) const {
  using Eight = Eigen::Array<float, 8, 1>;
  Eight px, py, pz;
  for (std::size_t k = 0; k < 8; ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    px[i] = places[k].x(), py[i] = places[k].y(), pz[i] = places[k].z();
  }
  const auto to = [&](float bx, float by, float bz, float radius) -> Eight {
    return root_of((px - bx).square() + (py - by).square() + (pz - bz).square()) - radius;
  };
  const Ball& known = balls_[static_cast<std::size_t>(ball)];
  Eight best = to(known.centre.x(), known.centre.y(), known.centre.z(), known.radius);
  float farthest = best.maxCoeff();
  float reach = farthest + spread;  // a ball farther from x than this is no nearest one
  walk(x, reach, [&](std::size_t block) {
    const Balls& b = blocks_[block];
    const Block dx = b.x - x.x(), dy = b.y - x.y(), dz = b.z - x.z();
    const Block out = (dx * across.x() + dy * across.y() + dz * across.z()).square();
    const Block beside = root_of((dx.square() + dy.square() + dz.square() - out).max(0.0f));
    const Block least = out + (beside - spread).square();
    const Block most = (b.radius + (farthest + kRounding)).max(0.0f).square();
    for (Eigen::Index k = 0; k < kBlock; ++k) {
      if (least[k] < most[k]) best = best.min(to(b.x[k], b.y[k], b.z[k], b.radius[k]));
    }
    farthest = best.maxCoeff();
    reach = farthest + spread;
  });
  std::array<float, 8> result;
  Eigen::Map<Eight>(result.data()) = best;
  return result;
}

}  // namespace palpable
