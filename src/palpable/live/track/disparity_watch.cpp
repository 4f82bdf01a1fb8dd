#include "palpable/live/track/disparity_watch.h"

#include <cmath>
#include <utility>

namespace palpable {
namespace {

// px; a calibration is taken to be right to less than this. Smaller: drift of a street's landmarks
// is mistaken for it, which reaches 0.3 px on the recording stereo_video_kitti1_long.
constexpr double kLeastError = 0.4;
constexpr double kLeastChange = 0.2;  // px, of an error that is not 0
constexpr double kMostError = 4;      // px; a larger one is no small turn of an eye
constexpr double kSigmasOfError = 4, kSigmasOfChange = 2.5;

}  // namespace

std::optional<double> DisparityWatch::add(double estimate, double information, double in_use) {
  const double off = estimate - in_use;
  const bool is_wrong = in_use != 0;
  const double least = is_wrong ? kLeastChange : kLeastError;
  const double sigmas = is_wrong ? kSigmasOfChange : kSigmasOfError;
  const bool differs = std::abs(off) >= least && std::abs(estimate) <= kMostError &&
                       off * off * information >= sigmas * sigmas;
  const int side = !differs ? 0 : off > 0 ? 1 : -1;
  if (std::exchange(last_side_, side) != side || side == 0) return std::nullopt;
  return estimate;
}

}  // namespace palpable
