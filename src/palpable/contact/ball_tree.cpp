#include "palpable/contact/ball_tree.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>

namespace palpable {
namespace {

using Eigen::Vector3f;

constexpr int kLeaf = 6;
// Halving 2^31 balls down to a leaf takes fewer levels; each leaves one box waiting.
constexpr std::size_t kDeepest = 40;

}  // namespace

int BallTree::add(int begin, int end) {
  const int index = static_cast<int>(nodes_.size());
  nodes_.emplace_back();
  Eigen::AlignedBox3f box;
  float largest = 0;
  for (int k = begin; k < end; ++k) {
    const Ball& ball = balls_[order_[k]];
    box.extend(ball.centre);
    largest = std::max(largest, ball.radius);
  }
  int second = 0;
  if (end - begin > kLeaf) {
    Vector3f::Index axis = 0;
    box.sizes().maxCoeff(&axis);
    const int middle = begin + (end - begin) / 2;
    std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                     [&](int a, int b) {
                       const float xa = balls_[a].centre[axis], xb = balls_[b].centre[axis];
                       return xa != xb ? xa < xb : a < b;
                     });
    add(begin, middle);
    second = add(middle, end);
  }
  nodes_[index] = {box.center(), box.sizes() / 2, largest, begin, end, second};
  return index;
}

void BallTree::reserve(std::size_t balls) {
  balls_.reserve(balls);
  order_.reserve(balls);
  sorted_.reserve(balls);
  nodes_.reserve(balls);  // a leaf holds two at least, so that there are fewer nodes than balls
}

void BallTree::build(std::span<const Ball> balls) {
  balls_.assign(balls.begin(), balls.end());
  order_.resize(balls.size());
  std::iota(order_.begin(), order_.end(), 0);
  nodes_.clear();
  if (!balls.empty()) add(0, static_cast<int>(balls.size()));
  sorted_.resize(balls.size());
  for (std::size_t k = 0; k < order_.size(); ++k) sorted_[k] = balls_[order_[k]];
}

std::optional<NearestBall> BallTree::nearest(const Vector3f& x, float reach) const {
  if (nodes_.empty()) return std::nullopt;
  struct Waiting {
    int node;
    float least;  // no ball in it can be nearer
  };
  const auto least_of = [&](int node) {
    const Node& n = nodes_[node];
    return ((x - n.middle).cwiseAbs() - n.half).cwiseMax(0.0f).norm() - n.largest_radius;
  };
  std::array<Waiting, kDeepest> stack;
  std::size_t waiting = 0;
  stack[waiting++] = {0, least_of(0)};
  float best = reach;
  int found = -1;
  while (waiting > 0) {
    const Waiting next = stack[--waiting];
    if (next.least >= best) continue;
    const Node& node = nodes_[next.node];
    if (node.second == 0) {
      for (int k = node.begin; k < node.end; ++k) {
        const float d = (sorted_[k].centre - x).norm() - sorted_[k].radius;
        if (d < best) {
          best = d;
          found = k;
        }
      }
      continue;
    }
    Waiting near{next.node + 1, least_of(next.node + 1)}, far{node.second, least_of(node.second)};
    if (far.least < near.least) std::swap(near, far);
    if (far.least < best) stack[waiting++] = far;
    if (near.least < best) stack[waiting++] = near;
  }
  if (found < 0) return std::nullopt;
  return NearestBall{best, order_[found]};
}

std::array<float, 8> BallTree::distances_around(const Vector3f& x, float spread,
                                                std::span<const Vector3f, 8> places,
                                                int ball) const {
  using Eight = Eigen::Array<float, 8, 1>;
  Eight px, py, pz;
  for (std::size_t k = 0; k < 8; ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    px[i] = places[k].x(), py[i] = places[k].y(), pz[i] = places[k].z();
  }
  const auto to = [&](const Ball& b) -> Eight {
    return ((px - b.centre.x()).square() + (py - b.centre.y()).square() +
            (pz - b.centre.z()).square())
               .sqrt() -
           b.radius;
  };
  Eight best = to(balls_[static_cast<std::size_t>(ball)]);
  float reach = best.maxCoeff() + spread;  // a ball that is farther from x is so from all of them
  std::array<int, kDeepest> stack;
  std::size_t waiting = 0;
  stack[waiting++] = 0;
  while (waiting > 0) {
    const int index = stack[--waiting];
    const Node& node = nodes_[index];
    if (((x - node.middle).cwiseAbs() - node.half).cwiseMax(0.0f).norm() - node.largest_radius >=
        reach) {
      continue;
    }
    if (node.second == 0) {
      for (int k = node.begin; k < node.end; ++k) best = best.min(to(sorted_[k]));
      reach = best.maxCoeff() + spread;
      continue;
    }
    stack[waiting++] = node.second;
    stack[waiting++] = index + 1;
  }
  std::array<float, 8> result;
  Eigen::Map<Eight>(result.data()) = best;
  return result;
}

}  // namespace palpable
