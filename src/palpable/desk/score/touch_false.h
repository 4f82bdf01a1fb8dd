/// @file
/// How often a touch is felt where nothing is.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace palpable {

/// m: an object that is farther away than this does not touch, by whatever camera it is seen.
inline constexpr double kNothingNear = 0.005;

/// Of all felt frames, the share in which no true object is within kNothingNear of the undeformed
/// body; nothing when none is felt, or when a felt frame's gap is not known.
/// @param gaps  m, from the nearest object to the undeformed body; 0 where one touches
/// @param felt  not 0 where a touch was felt; as many frames as `gaps`
/// @throws ContractViolation when the lists differ in length
[[nodiscard]] std::optional<double> touch_false(std::span<const std::optional<double>> gaps,
                                                std::span<const std::uint8_t> felt);

}  // namespace palpable
