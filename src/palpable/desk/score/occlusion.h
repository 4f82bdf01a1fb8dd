/// @file
/// Whether the body is drawn where it should be visible and hidden where an occluder is nearer.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/desk/score/share.h"

#include <cstdint>
#include <optional>

namespace palpable {

/// State of the body in a pixel.
enum class Sight : std::uint8_t {
  kNoBody,  ///< the body does not cover this pixel
  kHidden,  ///< an occluder is nearer
  kVisible
};
using SightImage = Image<Sight>;

/// The true state: the body is visible in a pixel unless something real is nearer,
///
///     visible = body_depth known  and  not (true_depth known  and  true_depth < body_depth)
///
/// @param body_depth  Z of the whole body, m, NaN elsewhere
/// @param true_depth  Z of the real scene, m, NaN where there is nothing; same size
/// @throws ContractViolation when the sizes differ
[[nodiscard]] SightImage true_sight(const DepthImage& body_depth, const DepthImage& true_depth);

/// The drawn state: visible where the mask is set, with or without a depth of the body.
/// @param visible     not 0 where the picture shows the body; of the size of the depth or twice
///                    that size (then a pixel counts as visible if two or more of its four are set)
/// @throws ContractViolation for another size
[[nodiscard]] SightImage drawn_sight(const MaskImage& visible, const DepthImage& body_depth);

/// Pixel counts of one frame or the sum over many frames.
struct MaskOverlap {
  std::int64_t both = 0;    ///< visible in truth and picture
  std::int64_t either = 0;  ///< visible in truth or picture
  std::int64_t body = 0;    ///< covered by the body, visible or hidden in truth
  std::int64_t hidden = 0;  ///< of these, hidden in truth

  /// Intersection over union; 1 when neither shows the body.
  [[nodiscard]] double iou() const { return share_of(both, either).value_or(1.0); }
};

/// @throws ContractViolation for unequal sizes
[[nodiscard]] MaskOverlap overlap_of(const SightImage& truth, const SightImage& drawn);

/// The same from the images: overlap_of(true_sight(...), drawn_sight(...)).
[[nodiscard]] MaskOverlap compare_visible(const MaskImage& visible, const DepthImage& body_depth,
                                          const DepthImage& true_depth);

/// Error of the border between the visible and the hidden part of the body. Border pixels are
/// visible and have a hidden 4-neighbour. The body's own outline is not part of it.
struct BorderError {
  double sum_px = 0;        ///< sum of the distances
  std::int64_t pixels = 0;  ///< border pixels of truth and picture
  /// Mean distance of a border pixel to the nearest pixel of the other border; nothing without
  /// border pixels.
  [[nodiscard]] std::optional<double> mean_px() const {
    if (pixels == 0) return std::nullopt;
    return sum_px / static_cast<double>(pixels);
  }
};

/// px, distance that counts for a border pixel if the other border is farther away or missing.
inline constexpr int kLargestBorderError = 25;

/// Distances from each border pixel of the truth to the drawn border and vice versa.
/// @throws ContractViolation for unequal sizes
[[nodiscard]] BorderError border_error(const SightImage& truth, const SightImage& drawn);

/// Whether the hand truly crosses the body's outline and leaves a part of the body visible:
///
///     some pixel of the hand that hides the body has a 4-neighbour of the hand beside the body,
///     and some pixel of the hand that hides the body has a 4-neighbour in which the body is
///     visible
///
/// A hand that is only in front of the middle of the body, or passes behind it, does not cross.
/// @param moving  not 0 where the real scene shows a moving thing; empty: everywhere
/// @throws ContractViolation for unequal sizes
[[nodiscard]] bool crosses_outline(const SightImage& truth, const MaskImage& moving);

/// Counts over the pixels that show the body in two successive frames and have the same true state
/// in both.
struct Flicker {
  std::int64_t pixels = 0;
  std::int64_t changed = 0;  ///< of these, drawn differently
  [[nodiscard]] std::optional<double> share() const { return share_of(changed, pixels); }
};

/// @throws ContractViolation for unequal sizes
[[nodiscard]] Flicker flicker_between(const SightImage& truth_before,
                                      const SightImage& drawn_before, const SightImage& truth,
                                      const SightImage& drawn);

}  // namespace palpable
