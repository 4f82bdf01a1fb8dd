#include "palpable/live/render/grid_cut.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <limits>

namespace palpable {

void GridCut::begin(int width, int height) {
  PALPABLE_EXPECT(width >= 0 && height >= 0, "a grid has no negative size");
  stride_ = width + 2;  // a rim of nodes without links, so that every node has four neighbours
  step_ = {1, -1, stride_, -stride_};
  const auto count = static_cast<std::size_t>(stride_) * static_cast<std::size_t>(height + 2);
  assign_with_room(left_, 4 * count, 0);
  assign_with_room(bias_, count, 0);
  assign_with_room(tree_, count, kFree);
  assign_with_room(parent_, count, kOrphan);
  assign_with_room(distance_, count, 0);
  assign_with_room(checked_, count, 0);
  assign_with_room(active_, count, std::uint8_t{0});
  for (std::vector<int>* list : {&queue_, &next_queue_, &orphans_}) {
    assign_with_room(*list, count, 0);
    list->clear();
  }
  time_ = 0;
}

void GridCut::activate(int node) {
  if (active_[node] != 0) return;
  active_[node] = 1;
  next_queue_.push_back(node);
}

void GridCut::solve() {
  for (int node = 0; node < static_cast<int>(bias_.size()); ++node) {
    if (bias_[node] == 0) continue;
    tree_[node] = bias_[node] > 0 ? kOne : kZero;
    parent_[node] = kRoot;
    distance_[node] = 1;
    activate(node);
  }
  while (!next_queue_.empty()) {
    std::swap(queue_, next_queue_);
    next_queue_.clear();
    for (const int node : queue_) {
      active_[node] = 0;
      while (tree_[node] != kFree) {
        const int direction = grow(node);
        if (direction < 0) break;
        ++time_;
        const bool from_one = tree_[node] == kOne;
        augment(from_one ? node : beside(node, direction), from_one ? direction : direction ^ 1);
        adopt();
      }
    }
  }
}

int GridCut::grow(int node) {
  for (int d = 0; d < 4; ++d) {
    if (outwards(node, d) <= 0) continue;
    const int other = beside(node, d);
    if (tree_[other] == kFree) {
      tree_[other] = tree_[node];
      parent_[other] = static_cast<std::uint8_t>(d ^ 1);
      checked_[other] = checked_[node];
      distance_[other] = distance_[node] + 1;
      activate(other);
    } else if (tree_[other] != tree_[node]) {
      return d;
    } else if (checked_[other] <= checked_[node] && distance_[other] > distance_[node] + 1) {
      parent_[other] = static_cast<std::uint8_t>(d ^ 1);  // a shorter way to the root
      checked_[other] = checked_[node];
      distance_[other] = distance_[node] + 1;
    }
  }
  return -1;
}

void GridCut::augment(int one, int direction) {
  const int zero = beside(one, direction);
  int flow = left_of(one, direction);
  int node = one;
  for (; parent_[node] != kRoot; node = beside(node, parent_[node])) {
    flow = std::min(flow, left_of(beside(node, parent_[node]), parent_[node] ^ 1));
  }
  flow = std::min(flow, bias_[node]);
  for (node = zero; parent_[node] != kRoot; node = beside(node, parent_[node])) {
    flow = std::min(flow, left_of(node, parent_[node]));
  }
  flow = std::min(flow, -bias_[node]);

  left_of(one, direction) -= flow;
  left_of(zero, direction ^ 1) += flow;
  for (node = one; parent_[node] != kRoot;) {
    const int d = parent_[node], parent = beside(node, d);
    left_of(node, d) += flow;
    if ((left_of(parent, d ^ 1) -= flow) == 0) orphan(node);
    node = parent;
  }
  if ((bias_[node] -= flow) == 0) orphan(node);
  for (node = zero; parent_[node] != kRoot;) {
    const int d = parent_[node], parent = beside(node, d);
    left_of(parent, d ^ 1) += flow;
    if ((left_of(node, d) -= flow) == 0) orphan(node);
    node = parent;
  }
  if ((bias_[node] += flow) == 0) orphan(node);
}

// The number of steps from a node to its root. Marks the nodes on the path as checked, so that
// later calls can stop there.
int GridCut::distance_to_root(int node) {
  constexpr int kNone = std::numeric_limits<int>::max();
  int steps = 0;
  int end = node;
  for (;; end = beside(end, parent_[end])) {
    if (checked_[end] == time_) {
      steps += distance_[end];
      break;
    }
    ++steps;
    if (parent_[end] == kOrphan) return kNone;
    if (parent_[end] == kRoot) {
      checked_[end] = time_;
      distance_[end] = 1;
      break;
    }
  }
  int distance = steps;
  for (int on_way = node; checked_[on_way] != time_; on_way = beside(on_way, parent_[on_way])) {
    checked_[on_way] = time_;
    distance_[on_way] = distance--;
  }
  return steps;
}

void GridCut::adopt() {
  constexpr int kNone = std::numeric_limits<int>::max();
  for (std::size_t k = 0; k < orphans_.size(); ++k) {
    const int node = orphans_[k];
    int best = kNone, parent = -1;
    for (int d = 0; d < 4; ++d) {
      const int other = beside(node, d);
      if (tree_[other] != tree_[node] || outwards(other, d ^ 1) <= 0) continue;
      if (parent_[other] == kOrphan) continue;
      const int distance = distance_to_root(other);
      if (distance < best) {
        best = distance;
        parent = d;
      }
    }
    if (parent >= 0) {
      parent_[node] = static_cast<std::uint8_t>(parent);
      checked_[node] = time_;
      distance_[node] = best + 1;
      continue;
    }
    for (int d = 0; d < 4; ++d) {
      const int other = beside(node, d);
      if (tree_[other] != tree_[node]) continue;
      if (outwards(other, d ^ 1) > 0) activate(other);
      if (parent_[other] == (d ^ 1)) orphan(other);
    }
    tree_[node] = kFree;
    checked_[node] = 0;
  }
  orphans_.clear();
}

}  // namespace palpable
