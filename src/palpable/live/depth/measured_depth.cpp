#include "palpable/live/depth/measured_depth.h"

#include "palpable/common/base/order_statistics.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

namespace palpable {
namespace {

// A float has 23 bits of fraction below its exponent: without its last 16 bits it is the number of
// a bin, of which an octave has 128.
constexpr int kBelowBin = 16;
constexpr int kFirstBin = (127 - 10) << 7;  // of 2^-10 m

}  // namespace

void DepthBins::add(float Z) {
  const int bin = static_cast<int>(std::bit_cast<std::uint32_t>(Z) >> kBelowBin) - kFirstBin;
  ++bins_[static_cast<std::size_t>(std::clamp(bin, 0, static_cast<int>(kBins) - 1))];
  ++count_;
}

void DepthBins::add(const DepthBins& other) {
  for (std::size_t i = 0; i < kBins; ++i) bins_[i] += other.bins_[i];
  count_ += other.count_;
}

void DepthBins::clear() {
  bins_.fill(0);
  count_ = 0;
}

double DepthBins::percentile(double share) const {
  if (count_ == 0) return 0;
  const std::size_t bin = percentile_bin(bins_, count_, share);
  constexpr std::uint32_t kMiddle = 1U << (kBelowBin - 1);
  const auto bits = (static_cast<std::uint32_t>(bin) + kFirstBin) << kBelowBin;
  return std::bit_cast<float>(bits | kMiddle);
}

void DepthSteps::add(int number, int before) {
  constexpr int kByte = 256;
  ++values;
  values_by_256 += number % kByte == 0;
  if (before > 0 && before != number) {
    ++changes;
    changes_by_256 += (number - before) % kByte == 0;
  }
  if (divisor != 1 && (divisor == 0 || number % divisor != 0)) divisor = std::gcd(divisor, number);
  constexpr std::uint32_t kSpread = 40503;  // 2^16 divided by the golden ratio, odd
  kinds.set((static_cast<std::uint32_t>(number) * kSpread & 0xFFFFU) >> 6U);
}

void DepthSteps::add(const DepthSteps& other) {
  values += other.values;
  values_by_256 += other.values_by_256;
  changes += other.changes;
  changes_by_256 += other.changes_by_256;
  divisor = std::gcd(divisor, other.divisor);
  kinds |= other.kinds;
}

void MeasuredDepth::clear() {
  measured = too_close = too_far = kept = 0;
  bins.clear();
  in_scene = 0;
  steps = {};
}

void MeasuredDepth::sample(float Z) {
  if (!(Z > 0) || Z > std::numeric_limits<float>::max()) return;
  bins.add(Z);
  in_scene += Z >= kNearScene && Z <= kFarScene;
}

}  // namespace palpable
