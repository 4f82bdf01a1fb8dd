/// @file
/// Which pixels show the same thing: two hands are two parts, a hand and what it holds are one.
#pragma once

#include "palpable/contact/silhouette.h"
#include "palpable/geometry/image.h"

#include <vector>

namespace palpable {

/// The parts of one frame's silhouette. Keeps its memory.
class PartLabels {
 public:
  static constexpr int kNone = -1;

  /// Pixels that press and are neighbours, with depths that belong to one surface, are one part.
  /// @param shows  as ObjectSurface::build
  void find(const DepthImage& depth, const MaskImage& shows, const PixelBox& box,
            const SilhouetteSettings& settings);

  /// 0 .. count() - 1, or kNone where there is no thing; of a pixel of the box.
  [[nodiscard]] int at(int x, int y) const {
    return label_[static_cast<std::size_t>(y - box_.y) * static_cast<std::size_t>(box_.width) +
                  static_cast<std::size_t>(x - box_.x)];
  }
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] const PixelBox& box() const { return box_; }

 private:
  int root(int label);

  PixelBox box_;
  std::vector<int> label_;   // by pixel of the box
  std::vector<int> parent_;  // by provisional label
  int count_ = 0;
};

}  // namespace palpable
