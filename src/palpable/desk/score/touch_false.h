/// @file
/// How often a touch is reported although no obstacle is near.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace palpable {

/// m; an obstacle farther away than this is no touch even with the error of a depth camera.
inline constexpr double kNothingNear = 0.005;

/// Share of the frames with a felt touch in which no obstacle is truly within kNothingNear of the
/// undeformed body. Nothing when no frame has a felt touch, or when the gap of such a frame is
/// unknown.
/// @param gaps  m, true distance of the nearest obstacle from the undeformed body; 0 for a touch
/// @param felt  not 0 where a touch was felt; as many frames as `gaps`
/// @throws ContractViolation when the lists differ in length
[[nodiscard]] std::optional<double> touch_false(std::span<const std::optional<double>> gaps,
                                                std::span<const std::uint8_t> felt);

}  // namespace palpable
