#include "palpable/desk/score/touch_recall.h"

#include "palpable/common/base/contract.h"
#include "palpable/desk/score/share.h"

#include <cstddef>

namespace palpable {

std::optional<double> touch_recall(std::span<const TrueReach> truth,
                                   std::span<const std::uint8_t> felt) {
  PALPABLE_EXPECT(truth.size() == felt.size(), "one entry per frame in both");
  int to_be_felt = 0;
  int found = 0;
  for (std::size_t f = 0; f < truth.size(); ++f) {
    if (truth[f].depth <= kFeltFrom || truth[f].seen_share < kSeenFrom) continue;
    ++to_be_felt;
    found += felt[f] != 0;
  }
  return share_of(found, to_be_felt);
}

}  // namespace palpable
