#include "palpable/common/base/order_statistics.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpable {

double percentile(std::vector<double> values, double share) {
  PALPABLE_EXPECT(!values.empty(), "no values have no percentile");
  PALPABLE_EXPECT(0 <= share && share <= 1, "a share is in [0, 1]");
  std::sort(values.begin(), values.end());
  const double rank = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(std::floor(rank));
  const std::size_t above = std::min(below + 1, values.size() - 1);
  const double t = rank - static_cast<double>(below);
  return values[below] + t * (values[above] - values[below]);
}

std::size_t percentile_bin(std::span<const std::uint32_t> bins, std::uint64_t count, double share) {
  const double rank = share * static_cast<double>(count - 1);
  std::uint64_t below = 0;
  for (std::size_t bin = 0; bin + 1 < bins.size(); ++bin) {
    below += bins[bin];
    if (static_cast<double>(below) > rank) return bin;
  }
  return bins.size() - 1;
}

}  // namespace palpable
