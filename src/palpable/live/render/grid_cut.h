/// @file
/// The minimum cut of a grid: divides pixels into two sides so that a sum of costs is minimal.
///
///     E(x) = sum_i (x_i = 0 ? bias_i : 0) + sum_{i, j neighbours} (x_i != x_j ? link_ij : 0)
///
/// With link >= 0 this is the capacity of a cut in a graph, and its exact minimum is found by
/// augmenting paths from two search trees that are kept between paths (Boykov and Kolmogorov 2004).
/// All numbers are integers, so that the result does not depend on the machine.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpable {

/// Fills a vector. Where it must grow, half as much again is reserved, since a body's rectangle may
/// grow a little from frame to frame.
template <class T>
void assign_with_room(std::vector<T>& to, std::size_t count, T value) {
  if (to.capacity() < count) to.reserve(count + count / 2);
  to.assign(count, value);
}

/// Neighbours are the pixels on the left and right, above and below. Set all costs between begin()
/// and solve().
class GridCut {
 public:
  /// Starts a grid of this size without costs. Allocates nothing up to a size that it has had.
  void begin(int width, int height);

  /// Adds to a pixel's bias. A bias above 0 is the cost of side 0, a bias below 0 is minus the cost
  /// of side 1.
  void add_bias(int x, int y, int bias) { bias_[at(x, y)] += bias; }
  /// Adds to the cost (>= 0) of having a pixel and its right, or its lower, neighbour on different
  /// sides. The neighbour must lie within the grid.
  void link_right(int x, int y, int cost) { link(at(x, y), kRight, cost); }
  void link_down(int x, int y, int cost) { link(at(x, y), kDown, cost); }

  /// Finds the minimum cut. Of several, it takes the one with the fewest pixels on side 1.
  void solve();

  /// The pixel's side after solve().
  [[nodiscard]] bool side(int x, int y) const { return tree_[at(x, y)] == kOne; }

 private:
  // Directions; the opposite of d is d ^ 1.
  static constexpr int kRight = 0, kDown = 2;
  static constexpr std::uint8_t kRoot = 4, kOrphan = 5;  // in place of the direction to a parent
  static constexpr std::uint8_t kFree = 0, kOne = 1, kZero = 2;

  [[nodiscard]] int at(int x, int y) const { return (y + 1) * stride_ + x + 1; }
  [[nodiscard]] int beside(int node, int direction) const {
    return node + step_[static_cast<std::size_t>(direction)];
  }
  [[nodiscard]] int& left_of(int node, int direction) {
    return left_[4 * static_cast<std::size_t>(node) + static_cast<std::size_t>(direction)];
  }
  void link(int node, int direction, int cost) {
    left_of(node, direction) += cost;
    left_of(beside(node, direction), direction ^ 1) += cost;
  }
  // The residual capacity between a node and its neighbour in the direction of flow in its tree:
  // away from the root in the first tree, towards it in the second.
  [[nodiscard]] int outwards(int node, int direction) {
    return tree_[node] == kOne ? left_of(node, direction)
                               : left_of(beside(node, direction), direction ^ 1);
  }
  void activate(int node);
  // The direction in which a path to the other tree was found, or -1.
  int grow(int node);
  void augment(int one, int direction);
  void adopt();
  [[nodiscard]] int distance_to_root(int node);
  void orphan(int node) {
    parent_[node] = kOrphan;
    orphans_.push_back(node);
  }

  int stride_ = 0;
  std::array<int, 4> step_{};
  std::vector<int> left_;  // residual capacity of each node and direction
  std::vector<int> bias_;  // residual capacity from (above 0) or to (below 0) the root
  std::vector<std::uint8_t> tree_, parent_;
  std::vector<int> distance_, checked_;  // to the root, as it was at time `checked_`
  std::vector<std::uint8_t> active_;
  std::vector<int> queue_, next_queue_, orphans_;
  int time_ = 0;
};

}  // namespace palpable
