#include "palpable/desk/score/depth_scores.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/desk/score/statistics.h"

#include <algorithm>
#include <cmath>
#include <utility>

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
  for (auto& histogram : errors_) histogram.assign(kErrorSteps + 1, 0);
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
      ++counts_.too_close_pixels;
      called_far_ += measured(f) && f > kFarShare * t;
    }
    const int k = distance_of_count_[t];
    if (k < 0 || (!labels.empty() && (labels.data()[i] & kBothSeeLabel) == 0)) continue;
    DepthAtDistance& distance = counts_.at[k];
    ++distance.pixels;
    if (!measured(f)) continue;
    ++distance.measured;
    distance.within += within(t, f);
    const double steps = std::round(relative_error(t, f) / kErrorStep);
    ++errors_[k][static_cast<std::size_t>(std::min(steps, 1.0 * kErrorSteps))];
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
  ++counts_.near_frames;
  hand_pixels_ += seen;
  hand_within_ += right;
}

DepthScore DepthScorer::score() const {
  DepthScore score = counts_;
  for (std::size_t k = 0; k < score.at.size(); ++k) {
    DepthAtDistance& at = score.at[k];
    at.median_error = median(errors_[k], at.measured);
    at.within_1pct = share_of(at.within, at.pixels);
    at.density = share_of(at.measured, at.pixels);
  }
  score.hand_within_1pct = share_of(hand_within_, hand_pixels_);
  score.too_close_called_far = share_of(called_far_, score.too_close_pixels);
  return score;
}

std::optional<double> warped_disagreement(std::span<const DepthImage> depths,
                                          std::span<const Rigid3> world_from_depth,
                                          const PinholeCamera& camera) {
  constexpr double kNearest = 0.1;      // m, smallest depth in image j
  constexpr double kSameSurface = 0.1;  // m, larger differences are different surfaces
  PALPABLE_EXPECT(depths.size() == world_from_depth.size(), "a pose per image");
  for (const DepthImage& depth : depths) {
    PALPABLE_EXPECT(depth.width() == camera.width && depth.height() == camera.height,
                    "images are of the camera's size");
  }
  std::vector<double> differences;
  for (std::size_t i = 0; i < depths.size(); i += 6) {
    for (const std::size_t apart : {5U, 15U, 40U}) {
      const std::size_t j = i + apart;
      if (j >= depths.size()) break;
      const Rigid3 j_from_i = world_from_depth[j].inverse() * world_from_depth[i];
      for (int y = 2; y < camera.height; y += 8) {
        for (int x = 2; x < camera.width; x += 8) {
          const auto Z = static_cast<double>(depths[i](x, y));
          if (!(Z > 0)) continue;
          const Eigen::Vector3d at = j_from_i * camera.unproject(x, y, Z);
          if (!(at.z() > kNearest)) continue;
          const Eigen::Vector2d uv = camera.project(at);
          const auto u = static_cast<int>(std::lround(uv.x()));
          const auto v = static_cast<int>(std::lround(uv.y()));
          if (u < 0 || v < 0 || u >= camera.width || v >= camera.height) continue;
          const double difference = std::abs(static_cast<double>(depths[j](u, v)) - at.z());
          if (difference < kSameSurface) differences.push_back(difference);  // false for NaN
        }
      }
    }
  }
  if (differences.empty()) return std::nullopt;
  return percentile(std::move(differences), 0.5);
}

}  // namespace palpable
