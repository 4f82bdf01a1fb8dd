#include "palpable/track/start_watch.h"

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

constexpr int kLeast = 50;  // depths that both views know; fewer say nothing
// Two depths of one place differ by no more sigma than this, but for one in a hundred.
constexpr float kSigmas = 2.5F;
constexpr float kOfTwo = 1.41421356F;  // the difference of two scatters more than each
// Of a camera that stands, what moves may hide almost half of the view.
constexpr double kSame = 0.5;

}  // namespace

StartWatch::Samples StartWatch::samples_of(const DepthImage& depth) {
  Samples samples;
  for (int j = 0; j < kDown; ++j) {
    const float* row = depth.row((2 * j + 1) * depth.height() / (2 * kDown));
    for (int i = 0; i < kAcross; ++i) {
      samples[static_cast<std::size_t>(j * kAcross + i)] =
          row[(2 * i + 1) * depth.width() / (2 * kAcross)];
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
  if (known < kLeast) return Stillness::kUnclear;
  return same >= kSame * known ? Stillness::kStill : Stillness::kMoved;
}

Stillness StartWatch::look(const GrayImage& image, const DepthImage& depth) {
  const Samples now = samples_of(depth);
  if (!begun_) {
    picture_.begin(image);
    first_ = now;
    // Something that can be compared with itself.
    begun_ =
        picture_.look(image, nullptr) == Stillness::kStill || compare(now) == Stillness::kStill;
    return begun_ ? Stillness::kStill : Stillness::kUnclear;
  }
  const Stillness seen = picture_.look(image, nullptr);
  return seen != Stillness::kUnclear ? seen : compare(now);
}

}  // namespace palpable
