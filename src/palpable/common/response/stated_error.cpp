#include "palpable/common/response/stated_error.h"

#include "palpable/common/base/order_statistics.h"
#include "palpable/common/response/held_out_touch.h"

#include <cstddef>

namespace palpable {
namespace {

// Weights of the indicators, fitted to touches of the demo's bunny so that the fewest errors are
// understated (docs/touch.md). With a factor near 1 they mean: the whole penetration is missing in
// the displacement, a fifth of what is beyond the linear displacement may be wrong, and more than
// half of the cross terms, of which only the second order is known.
constexpr double kOfEntry = 1.1, kOfBeyond = 0.2, kOfCross = 0.6;

}  // namespace

double unscaled_error(const ErrorIndicators& indicators) {
  return kOfEntry * indicators.entry + kOfBeyond * indicators.beyond + kOfCross * indicators.cross;
}

std::optional<ErrorScale> error_scale(const std::vector<HeldOutTouch>& touches) {
  std::vector<double> displacement, von_mises;
  for (const HeldOutTouch& touch : touches) {
    if (!touch.unscaled_error || !(*touch.unscaled_error > 0)) continue;
    displacement.push_back(touch.displacement / *touch.unscaled_error);
    von_mises.push_back(touch.von_mises / *touch.unscaled_error);
  }
  if (displacement.size() < static_cast<std::size_t>(kLeastTouches)) return std::nullopt;
  return ErrorScale{kOnTheSafeSide * percentile(displacement, 0.5),
                    kOnTheSafeSide * percentile(von_mises, 0.5)};
}

}  // namespace palpable
