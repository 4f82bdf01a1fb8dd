#include "palpable/desk/score/camera_scores.h"

#include "palpable/common/base/contract.h"

#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpable {
namespace {

constexpr double kClock = 1e-6;  // s, rounding of times in files, which have 6 decimals
constexpr double kLatest = 1.5;  // largest time between two compared poses, ratio to the span

}  // namespace

std::vector<PosePair> match_in_time(std::span<const StampedPose> truth,
                                    std::span<const StampedPose> found, double largest_gap) {
  std::vector<PosePair> pairs;
  std::size_t k = 0;
  for (const StampedPose& pose : truth) {
    const auto gap = [&](std::size_t i) { return std::abs(found[i].time - pose.time); };
    while (k + 1 < found.size() && gap(k + 1) <= gap(k)) ++k;
    if (k < found.size() && gap(k) <= largest_gap)
      pairs.push_back({pose.time, pose.world_from_camera, found[k].world_from_camera});
  }
  return pairs;
}

Rigid3 align_positions(std::span<const PosePair> pairs) {
  PALPABLE_EXPECT(!pairs.empty(), "an alignment needs at least one pair of poses");
  Eigen::Vector3d mean_true = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_found = Eigen::Vector3d::Zero();
  for (const PosePair& pair : pairs) {
    mean_true += pair.truth.translation() / static_cast<double>(pairs.size());
    mean_found += pair.found.translation() / static_cast<double>(pairs.size());
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const PosePair& pair : pairs) {
    covariance += (pair.truth.translation() - mean_true) *
                  (pair.found.translation() - mean_found).transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  // A sign makes the nearest orthogonal matrix a rotation and not a reflection.
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0) signs.z() = -1;
  Rigid3 aligned = Rigid3::Identity();
  aligned.linear() = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  aligned.translation() = mean_true - aligned.linear() * mean_found;
  return aligned;
}

TrajectoryScore score_trajectory(std::span<const PosePair> pairs, double span) {
  PALPABLE_EXPECT(span > 0, "the time span of a relative error is positive");
  const Rigid3 true_from_found = align_positions(pairs);
  TrajectoryScore score;
  score.poses = static_cast<int>(pairs.size());
  double squares = 0;
  for (const PosePair& pair : pairs) {
    squares +=
        (pair.truth.translation() - true_from_found * pair.found.translation()).squaredNorm();
  }
  score.ate = std::sqrt(squares / static_cast<double>(pairs.size()));

  double lengths = 0;
  double angles = 0;
  int count = 0;
  std::size_t j = 0;
  for (const PosePair& from : pairs) {
    while (j < pairs.size() && pairs[j].time < from.time + span - kClock) ++j;
    if (j == pairs.size()) break;
    const PosePair& to = pairs[j];
    if (to.time > from.time + kLatest * span) continue;
    const Rigid3 true_motion = from.truth.inverse() * to.truth;
    const Rigid3 error = true_motion.inverse() * (from.found.inverse() * to.found);
    lengths += error.translation().squaredNorm();
    angles += std::pow(Eigen::AngleAxisd(error.linear()).angle(), 2);
    ++count;
  }
  if (count > 0) {
    score.rpe = std::sqrt(lengths / count);
    score.rpe_angle = std::sqrt(angles / count);
  }
  return score;
}

void AnchorScorer::add(const Rigid3& true_world_from_camera, const Rigid3& drawn_camera_from_body) {
  const Eigen::Vector3d p = true_world_from_camera * drawn_camera_from_body.translation();
  ++frames_;
  const Eigen::Vector3d from_old_mean = p - mean_;
  mean_ += from_old_mean / frames_;
  squares_ += from_old_mean.dot(p - mean_);
}

std::optional<double> AnchorScorer::jitter() const {
  if (frames_ == 0) return std::nullopt;
  return std::sqrt(squares_ / frames_);
}

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
