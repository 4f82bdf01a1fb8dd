#include "palpable/contact/part_labels.h"

#include <algorithm>
#include <cmath>

namespace palpable {

int PartLabels::root(int label) {
  while (parent_[label] != label) {
    parent_[label] = parent_[parent_[label]];
    label = parent_[label];
  }
  return label;
}

void PartLabels::find(const DepthImage& depth, const MaskImage& shows, const PixelBox& box,
                      const SilhouetteSettings& settings) {
  box_ = box;
  label_.assign(static_cast<std::size_t>(box_.width) * static_cast<std::size_t>(box_.height),
                kNone);
  parent_.clear();
  std::size_t k = 0;
  for (int y = box_.y; y < box_.y + box_.height; ++y) {
    for (int x = box_.x; x < box_.x + box_.width; ++x, ++k) {
      const float z = depth(x, y);
      if (!(z > 0) || (!shows.empty() && shows(x, y) != kShowsPresser)) continue;
      const float jump = depth_jump(settings, z);
      int mine = kNone;
      const auto join = [&](int u, int v, std::size_t other) {
        if (label_[other] == kNone || !(std::abs(z - depth(u, v)) <= jump)) return;
        const int theirs = root(label_[other]);
        if (mine == kNone) {
          mine = theirs;
        } else {
          const auto [low, high] = std::minmax(mine, theirs);
          parent_[high] = low;
          mine = low;
        }
      };
      if (x > box_.x) join(x - 1, y, k - 1);
      if (y > box_.y) join(x, y - 1, k - static_cast<std::size_t>(box_.width));
      if (mine == kNone) {
        mine = static_cast<int>(parent_.size());
        parent_.push_back(mine);
      }
      label_[k] = mine;
    }
  }
  // A label points to a lower one, which has its final number by then.
  count_ = 0;
  for (std::size_t i = 0; i < parent_.size(); ++i) {
    parent_[i] = parent_[i] == static_cast<int>(i) ? count_++ : parent_[parent_[i]];
  }
  for (int& label : label_) {
    if (label != kNone) label = parent_[label];
  }
}

}  // namespace palpable
