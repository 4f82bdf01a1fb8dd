/// @file
/// Comparison of the frames with a felt touch and those with a true touch.
///
///   n  frames; both lists have one entry per frame, 0 or 1, from frame 0 on
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace palpable {

struct TouchScore {
  int frames = 0;
  int truly_touching = 0;  ///< frames
  int found_touching = 0;  ///< frames
  int both = 0;            ///< frames
  /// First found minus first true touching frame; negative when a touch was felt too early. Nothing
  /// when one of the two lists has no touch.
  std::optional<int> first_touch_delay_frames;
  /// Share of the found touching frames that are true; nothing when none was found.
  std::optional<double> precision;
  /// Share of the true touching frames that were found; nothing when there are none.
  std::optional<double> recall;
};

/// @throws ContractViolation when the lists differ in length
[[nodiscard]] TouchScore score_touches(std::span<const std::uint8_t> truth,
                                       std::span<const std::uint8_t> found);

/// Whether touches were felt at the right site: among the frames in which truth and result both
/// have a site, the share in which it is the same; nothing without such a frame.
/// @param truth, found  site per frame; -1 without a touch, or for a true touch between sites
/// @throws ContractViolation when the lists differ in length
[[nodiscard]] std::optional<double> score_sites(std::span<const int> truth,
                                                std::span<const int> found);

}  // namespace palpable
