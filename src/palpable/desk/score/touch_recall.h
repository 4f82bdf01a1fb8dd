/// @file
/// How often a touch that the cameras can see is felt.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace palpable {

/// How far an obstacle truly reaches into the undeformed body, in one frame.
struct TrueReach {
  double depth = 0;       ///< m; 0 without a touch
  double seen_share = 1;  ///< of the obstacle's touching surface (clip_files/frame_records.h)
};

/// m; shallower touches may be below the noise of the camera.
inline constexpr double kFeltFrom = 0.003;
/// Share of the touching surface. A touch that is seen less is not counted as missed.
inline constexpr double kSeenFrom = 0.5;

/// Share of frames with a felt touch among those in which the obstacle is more than kFeltFrom deep
/// and at least kSeenFrom of its touching surface is seen; nothing without such a frame.
/// @param felt  not 0 where a touch was felt; as many frames as `truth`
/// @throws ContractViolation when the lists differ in length
[[nodiscard]] std::optional<double> touch_recall(std::span<const TrueReach> truth,
                                                 std::span<const std::uint8_t> felt);

}  // namespace palpable
