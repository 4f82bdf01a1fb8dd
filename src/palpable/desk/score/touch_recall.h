/// @file
/// Whether a touch that a camera can see is felt.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace palpable {

/// How far an object truly reaches into the undeformed body, in one frame.
struct TrueReach {
  double depth = 0;       ///< m; 0 without a touch
  double seen_share = 1;  ///< of the object's touching part (contact_file.h)
};

/// m: what is less deep may be the camera's noise.
inline constexpr double kFeltFrom = 0.003;
/// Of the touching part. What no camera sees is true, but not missed.
inline constexpr double kSeenFrom = 0.5;

/// Of the frames in which the object is more than kFeltFrom deep and kSeenFrom or more of its
/// touching part is seen, the share that is felt; nothing without such a frame.
/// @param felt  not 0 where a touch was felt; as many frames as `truth`
/// @throws ContractViolation when the lists differ in length
[[nodiscard]] std::optional<double> touch_recall(std::span<const TrueReach> truth,
                                                 std::span<const std::uint8_t> felt);

}  // namespace palpable
