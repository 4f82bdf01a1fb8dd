#include "palpable/desk/score/depth_score.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/desk/score/share.h"

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

constexpr double kDistanceShare = 0.15;  // half width of a distance class, relative to the distance
constexpr double kWithin = 0.01;         // relative error that still counts as right
constexpr double kHandNearest = 0.12;    // m, smallest median depth of a near hand
constexpr double kHandFarthest = 0.50;   // m, largest median depth of a near hand
constexpr double kHandShare = 0.05;      // smallest share of the image that a near hand covers
constexpr double kTooNear = 0.11;        // m, below it a true depth is too close to measure
constexpr double kFarShare = 1.20;       // ratio of measured to true depth that counts as far
constexpr double kErrorStep = 1e-5;      // bin width of the histogram of relative errors
constexpr std::size_t kErrorSteps = 100'000;

bool measured(std::uint16_t count) { return count != kNoDepth && count != kTooClose; }

double relative_error(std::uint16_t truth, std::uint16_t found) {
  return std::abs(static_cast<double>(found) - truth) / truth;
}

// The factor keeps an error of exactly 1 %, such as 2 counts of 200, within the limit although 0.01
// is rounded.
bool within(std::uint16_t truth, std::uint16_t found) {
  return measured(found) && relative_error(truth, found) <= kWithin * (1 + 1e-12);
}

// The median of a histogram; for an even number of values the mean of the middle two.
std::optional<double> median(const std::vector<std::int64_t>& counts, std::int64_t total) {
  if (total == 0) return std::nullopt;
  const auto value_at = [&](std::int64_t rank) {
    std::size_t i = 0;
    for (std::int64_t below = counts[0]; below <= rank; below += counts[i]) ++i;
    return static_cast<double>(i) * kErrorStep;
  };
  return 0.5 * (value_at((total - 1) / 2) + value_at(total / 2));
}

}  // namespace

DepthScorer::DepthScorer(double unit) : unit_(unit), distance_of_count_(65536, -1) {
  PALPABLE_EXPECT(unit > 0, "a count of depth has a length");
  for (std::size_t count = 1; count < distance_of_count_.size(); ++count) {
    const double z = static_cast<double>(count) * unit;
    for (std::size_t k = 0; k < kDepthDistances.size(); ++k) {
      if (std::abs(z / kDepthDistances[k] - 1) <= kDistanceShare + 1e-9)
        distance_of_count_[count] = static_cast<std::int8_t>(k);
    }
  }
  for (Distance& distance : distances_) distance.errors.assign(kErrorSteps + 1, 0);
}

void DepthScorer::add(const DepthCounts& truth, const MaskImage& labels, const DepthCounts& found) {
  const auto fits = [&](const auto& image) {
    return image.width() == truth.width() && image.height() == truth.height();
  };
  PALPABLE_EXPECT(fits(found), "true and measured depth have one size");
  PALPABLE_EXPECT(labels.empty() || fits(labels), "labels are as large as the depth");
  add_distances(truth, labels, found);
  if (!labels.empty()) add_hand(truth, labels, found);
}

void DepthScorer::add_distances(const DepthCounts& truth, const MaskImage& labels,
                                const DepthCounts& found) {
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const std::uint16_t t = truth.data()[i];
    const std::uint16_t f = found.data()[i];
    if (t == kNoDepth) continue;
    if (t * unit_ < kTooNear * (1 - 1e-9)) {
      ++too_close_;
      called_far_ += measured(f) && f > kFarShare * t;
    }
    const int k = distance_of_count_[t];
    if (k < 0 || (!labels.empty() && (labels.data()[i] & kBothSeeLabel) == 0)) continue;
    Distance& distance = distances_[k];
    ++distance.pixels;
    if (!measured(f)) continue;
    ++distance.measured;
    distance.within += within(t, f);
    const double steps = std::round(relative_error(t, f) / kErrorStep);
    ++distance.errors[static_cast<std::size_t>(std::min(steps, 1.0 * kErrorSteps))];
  }
}

void DepthScorer::add_hand(const DepthCounts& truth, const MaskImage& labels,
                           const DepthCounts& found) {
  hand_.clear();
  std::int64_t seen = 0;
  std::int64_t right = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const std::uint16_t t = truth.data()[i];
    if ((labels.data()[i] & kMovesLabel) == 0 || t == kNoDepth) continue;
    hand_.push_back(t);
    if ((labels.data()[i] & kBothSeeLabel) == 0) continue;
    ++seen;
    right += within(t, found.data()[i]);
  }
  if (static_cast<double>(hand_.size()) < kHandShare * static_cast<double>(truth.size())) return;
  if (hand_.empty()) return;
  const double depth = upper_median(hand_) * unit_;
  if (depth < kHandNearest || depth > kHandFarthest) return;
  ++near_frames_;
  hand_pixels_ += seen;
  hand_within_ += right;
}

DepthScore DepthScorer::score() const {
  DepthScore score;
  for (std::size_t k = 0; k < distances_.size(); ++k) {
    const Distance& from = distances_[k];
    DepthAtDistance& to = score.at[k];
    to.pixels = from.pixels;
    to.measured = from.measured;
    to.within = from.within;
    to.median_error = median(from.errors, from.measured);
    to.within_1pct = share_of(from.within, from.pixels);
    to.density = share_of(from.measured, from.pixels);
  }
  score.hand_within_1pct = share_of(hand_within_, hand_pixels_);
  score.near_frames = near_frames_;
  score.too_close_called_far = share_of(called_far_, too_close_);
  score.too_close_pixels = too_close_;
  return score;
}

}  // namespace palpable
