/// @file
/// Whether the body is drawn where it is seen and hidden where something real is nearer.
#pragma once

#include "palpable/geometry/image.h"

#include <cstdint>

namespace palpable {

/// Pixels of one frame or, added up, of many.
struct MaskOverlap {
  std::int64_t both = 0;    ///< visible in truth and picture
  std::int64_t either = 0;  ///< visible in truth or picture
  std::int64_t body = 0;    ///< where the body would be seen if nothing hid it
  std::int64_t hidden = 0;  ///< of these, hidden in truth

  /// Intersection over union; 1 when neither shows the body.
  [[nodiscard]] double iou() const {
    return either == 0 ? 1.0 : static_cast<double>(both) / static_cast<double>(either);
  }
};

/// Compares the mask of the drawn body with the one that the truth implies: the body is visible in
/// a pixel unless something real is nearer,
///
///     visible = body_depth known  and  not (true_depth known  and  true_depth < body_depth)
///
/// @param visible     255 where the picture shows the body; the size of the depths, or twice that
///                    (then a pixel counts as visible if two or more of its four are)
/// @param body_depth  Z of the whole body, m, NaN elsewhere
/// @param true_depth  Z of the real scene, m, NaN where there is nothing; same size
/// @throws ContractViolation for other sizes
[[nodiscard]] MaskOverlap compare_visible(const MaskImage& visible, const DepthImage& body_depth,
                                          const DepthImage& true_depth);

}  // namespace palpable
