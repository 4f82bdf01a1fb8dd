#include "palpable/desk/score/touch_false.h"

#include "palpable/common/base/contract.h"
#include "palpable/desk/score/share.h"

#include <cstddef>

namespace palpable {

std::optional<double> touch_false(std::span<const std::optional<double>> gaps,
                                  std::span<const std::uint8_t> felt) {
  PALPABLE_EXPECT(gaps.size() == felt.size(), "one entry per frame in both");
  int all = 0;
  int wrong = 0;
  for (std::size_t f = 0; f < gaps.size(); ++f) {
    if (felt[f] == 0) continue;
    if (!gaps[f]) return std::nullopt;
    ++all;
    wrong += *gaps[f] > kNothingNear;
  }
  return share_of(wrong, all);
}

}  // namespace palpable
