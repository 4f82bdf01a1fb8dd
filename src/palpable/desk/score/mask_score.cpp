#include "palpable/desk/score/mask_score.h"

#include "palpable/common/base/contract.h"
#include "palpable/desk/score/share.h"

#include <cstddef>

namespace palpable {

MaskScore& MaskScore::operator+=(const MaskScore& other) {
  truth += other.truth;
  found += other.found;
  both += other.both;
  pixels += other.pixels;
  return *this;
}

std::optional<double> MaskScore::iou() const {
  if (truth == 0) return std::nullopt;
  return share_of(both, truth + found - both);
}
std::optional<double> MaskScore::recall() const { return share_of(both, truth); }
std::optional<double> MaskScore::false_alarms() const { return share_of(found - both, pixels); }

MaskScore compare_masks(const GrayImage& truth, std::uint8_t bit, const MaskImage& found) {
  PALPABLE_EXPECT(truth.width() == found.width() && truth.height() == found.height(),
                  "masks of one frame have one size");
  MaskScore score;
  score.pixels = static_cast<std::int64_t>(truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const bool is_true = (truth.data()[i] & bit) != 0;
    const bool is_found = found.data()[i] != 0;
    score.truth += is_true;
    score.found += is_found;
    score.both += is_true && is_found;
  }
  return score;
}

MaskScore missing_mask(const GrayImage& truth, std::uint8_t bit) {
  MaskScore score;
  for (const std::uint8_t label : truth) score.truth += (label & bit) != 0;
  return score;
}

}  // namespace palpable
