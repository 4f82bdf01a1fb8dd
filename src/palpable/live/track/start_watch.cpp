#include "palpable/live/track/start_watch.h"

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

constexpr int kLeastDepths = 50;  // fewest depths known in both views that are compared
// sigma of the difference; two measurements of the same depth differ by more in 1.2 % of cases.
constexpr float kSigmas = 2.5F;
constexpr float kOfTwo = 1.41421356F;  // sigma of a difference, ratio to sigma of one measurement
// Share of the depths that must be unchanged: something that moves in front of a standing camera
// may hide almost half of the view.
constexpr double kSame = 0.5;

}  // namespace

StartWatch::Samples StartWatch::samples_of(const DepthImage& depth) {
  Samples samples;
  for (int j = 0; j < kDown; ++j) {
    const float* row = depth.row((2 * j + 1) * depth.height() / (2 * kDown));
    for (int i = 0; i < kAcross; ++i) {
      samples[j * kAcross + i] = row[(2 * i + 1) * depth.width() / (2 * kAcross)];
    }
  }
  return samples;
}

Stillness StartWatch::compare(const Samples& now) const {
  int known = 0, same = 0;
  for (std::size_t s = 0; s < now.size(); ++s) {
    if (!std::isfinite(now[s]) || !std::isfinite(first_[s])) continue;
    ++known;
    const float scatter = kOfTwo * noise_.sigma_in_float(std::max(now[s], first_[s]));
    same += std::abs(now[s] - first_[s]) < kSigmas * scatter ? 1 : 0;
  }
  if (known < kLeastDepths) return Stillness::kUnclear;
  return same >= kSame * known ? Stillness::kStill : Stillness::kMoved;
}

Stillness StartWatch::look(const GrayImage& image, const DepthImage& depth) {
  const Samples now = samples_of(depth);
  if (!begun_) {
    picture_.begin(image, depth);
    first_ = now;
    // The view is usable if it can be compared with itself.
    begun_ = picture_.look(image, depth, nullptr) == Stillness::kStill ||
             compare(now) == Stillness::kStill;
    return begun_ ? Stillness::kStill : Stillness::kUnclear;
  }
  const Stillness seen = picture_.look(image, depth, nullptr);
  return seen != Stillness::kUnclear ? seen : compare(now);
}

}  // namespace palpable
