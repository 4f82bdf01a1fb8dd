#include "palpable/live/depth/depth_watch.h"

#include <algorithm>
#include <cmath>

namespace palpable {

DepthTrouble DepthWatch::look(double density, double row_error_px) {
  constexpr double kPart = 1.0 / 16;  // weight of a new frame in the average
  smooth_ = seen_ == 0 ? density : smooth_ + kPart * (density - smooth_);
  ++seen_;
  if (seen_ >= settings_.frames) best_ = std::max(best_, smooth_);
  few_ = density < std::max(settings_.few, settings_.of_best * best_) ? few_ + 1 : 0;
  if (!std::isnan(row_error_px)) {
    rows_off_ = std::abs(row_error_px) > settings_.rows_off_px ? rows_off_ + 1 : 0;
  }
  if (rows_off_ >= settings_.frames) return DepthTrouble::kRowsOff;
  return few_ >= settings_.frames ? DepthTrouble::kFewDepths : DepthTrouble::kNone;
}

}  // namespace palpable
