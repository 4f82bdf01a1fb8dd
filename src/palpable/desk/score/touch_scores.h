/// @file
/// When touches are felt: compared with the true ones frame by frame, how often a touch that the
/// cameras can see is felt, and how often one is reported although no obstacle is near.
///
///   n  frames; all lists have one entry per frame, from frame 0 on
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

/// How far an obstacle truly reaches into the undeformed body, in one frame.
struct TrueReach {
  double depth = 0;       ///< m; 0 without a touch
  double seen_share = 1;  ///< of the obstacle's touching surface (contact_file.h)
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
