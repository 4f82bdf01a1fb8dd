/// @file
/// Masks and pictures: comparison of a mask, such as that of moving things, with the true one; and
/// whether the body is drawn where it should be visible and hidden where an occluder is nearer.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/desk/score/statistics.h"

#include <cstdint>
#include <optional>

namespace palpable {

/// Pixel counts of one frame or the sum over many frames.
struct MaskScore {
  std::int64_t truth = 0;   ///< set in the truth
  std::int64_t found = 0;   ///< set in the result
  std::int64_t both = 0;    ///< set in both
  std::int64_t pixels = 0;  ///< compared pixels: those of frames with a mask

  MaskScore& operator+=(const MaskScore& other);

  /// Intersection over union. Nothing when the truth is empty, because it would then be 0 for a
  /// single wrong pixel as for a million.
  [[nodiscard]] std::optional<double> iou() const;
  /// Share of the true pixels that were found; nothing when there are none.
  [[nodiscard]] std::optional<double> recall() const;
  /// Share of the compared pixels that are set in the result only; nothing when none were compared.
  [[nodiscard]] std::optional<double> false_alarms() const;
};

/// Compares one frame.
/// @param truth  bit `bit` of each pixel is the true mask
/// @param found  not 0 where the result sets the mask; the same size
/// @throws ContractViolation when the sizes differ
[[nodiscard]] MaskScore compare_masks(const GrayImage& truth, std::uint8_t bit,
                                      const MaskImage& found);

/// A frame without a mask: its true pixels count as missed, and none of its pixels as compared.
[[nodiscard]] MaskScore missing_mask(const GrayImage& truth, std::uint8_t bit);

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

/// A mask of half the size: a pixel is set if two or more of its four are.
[[nodiscard]] MaskImage half_of(const MaskImage& mask);

/// The drawn state: visible where the mask is set, with or without a depth of the body.
/// @param visible     not 0 where the picture shows the body; of the size of the depth or twice
///                    that size (then half_of() it)
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
