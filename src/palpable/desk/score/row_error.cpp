#include "palpable/desk/score/row_error.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpable {

std::optional<double> largest_row_error(std::span<const TrueRowOffset> truth,
                                        std::span<const RowCorrection> corrections, int settle,
                                        std::span<const std::uint8_t> processed) {
  PALPABLE_EXPECT(settle >= 0, "settling takes no negative time");
  PALPABLE_EXPECT(processed.empty() || processed.size() == truth.size(), "one mark per frame");
  std::optional<double> largest;
  std::optional<int> last_step;
  std::size_t k = 0;
  double correction = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const TrueRowOffset& frame = truth[i];
    for (; k < corrections.size() && corrections[k].frame <= frame.frame; ++k)
      correction = corrections[k].correction_px;
    if (frame.step) last_step = frame.frame;
    if (last_step && frame.frame <= *last_step + settle) continue;
    if (!processed.empty() && processed[i] == 0) continue;
    largest = std::max(largest.value_or(0), std::abs(frame.offset_px - correction));
  }
  return largest;
}

}  // namespace palpable
