#include "palpable/live/track/pose_search.h"

#include "palpable/common/base/order_statistics.h"

#include <algorithm>
#include <array>
#include <limits>

namespace palpable {
namespace {

// The coarse search uses the best landmarks, spread over the picture, so that not all of them lie
// on a hand.
constexpr int kCoarseCells = 8;       // cells across and down
constexpr int kMostOfCell = 3;        // landmarks per cell at most
constexpr int kCoarse = 64;           // landmarks in total at most
constexpr int kLeastCoarse = 8;       // landmarks that must be found
constexpr int kCoarseInliers = 7;     // landmarks that must agree
constexpr double kCoarseSigma = 0.2;  // px at level 0; doubles per level

// Normalised cross correlation from which a patch counts as found in the coarse search.
constexpr double kCoarseLikeness = 0.6;

// Share of the landmarks found that must agree with a pose.
constexpr double kLeastShareAgreeing = 0.4;
// px of a level; finer levels of the pyramid with more smear are not searched, because a template
// with so much smear is flat.
constexpr double kSmearPerLevel = 3.0;
// Frames in which a landmark must have agreed before its trust no longer depends on its age.
constexpr double kFullyTrusted = 15;

// A landmark is marked as dead if it was found elsewhere in more than 4 frames and more than half
// as often as it agreed, or if it was missed in more than 30 frames and more than 4 times as often
// as it agreed.
constexpr int kMostOutliers = 4, kMostMissed = 30, kMissedPerInlier = 4;

}  // namespace

PoseSearch::PoseSearch(const TrackerSettings& settings) {
  points_.reserve(settings.most_landmarks);
  point_candidate_.reserve(points_.capacity());
  fit_.inlier.reserve(points_.capacity());
  // There is one candidate per cell before the best are selected. This suffices unless a picture
  // is higher than wide.
  candidates_.reserve(LandmarkSearch::kCellsAcross * LandmarkSearch::kCellsAcross);
  smears_.reserve(candidates_.capacity());
  was_found_.reserve(candidates_.capacity());
  cells_.reserve(candidates_.capacity());
}

std::optional<Rigid3> PoseSearch::find(const LandmarkSearch& search, const TrackerFrame& frame,
                                       const PoseQuery& query) {
  Rigid3 pose = query.guess;
  if (query.coarse_first && !improve_coarsely(search, frame, query, pose)) return std::nullopt;
  select(search, frame, pose, query);
  find_candidates(search, frame);
  if (static_cast<int>(points_.size()) < query.least_inliers) return std::nullopt;
  fit_pose(search.settings.camera, points_, pose, {.tukey = 5, .first_width = 4, .steps = 12},
           fit_);
  if (!fit_.solved || fit_.inliers < query.least_inliers ||
      fit_.inliers < kLeastShareAgreeing * static_cast<double>(points_.size())) {
    return std::nullopt;
  }
  return fit_.camera_from_world;
}

// Selects the landmarks that should be visible from `pose`, and computes the median smear.
void PoseSearch::select(const LandmarkSearch& search, const TrackerFrame& frame, const Rigid3& pose,
                        const PoseQuery& query) {
  search.select(frame, pose, query.previous, query.exposure, query.frame_count, cells_,
                candidates_);
  smears_.clear();
  for (const Candidate& candidate : candidates_) smears_.push_back(candidate.smear.norm());
  smear_px_ = smears_.empty() ? 0 : upper_median(smears_);
}

// Improves a pose with few landmarks in small images, in case the guess has a large error.
bool PoseSearch::improve_coarsely(const LandmarkSearch& search, const TrackerFrame& frame,
                                  const PoseQuery& query, Rigid3& pose) {
  select(search, frame, pose, query);
  const TrackCamera& camera = search.settings.camera;
  const PinholeCamera& c = camera.camera;
  std::array<int, kCoarseCells * kCoarseCells> used{};
  points_.clear();
  for (const Candidate& candidate : candidates_) {
    if (points_.size() >= kCoarse) break;
    const int cx =
        std::min(static_cast<int>(candidate.uv.x()) * kCoarseCells / c.width, kCoarseCells - 1);
    const int cy =
        std::min(static_cast<int>(candidate.uv.y()) * kCoarseCells / c.height, kCoarseCells - 1);
    int& count = used[cy * kCoarseCells + cx];
    if (count >= kMostOfCell) continue;
    ++count;
    Eigen::Vector2d uv;
    int level = 0;
    if (!search.find(candidate, 3, 2, kCoarseLikeness, uv, level)) continue;
    const Landmark& landmark = search.map.landmarks[candidate.landmark];
    PosePoint point;
    point.x_in_world = landmark.x_in_world;
    point.seen.uvd = {uv.x(), uv.y(), std::numeric_limits<double>::quiet_NaN()};
    point.seen.sigma = kCoarseSigma * (1 << level);
    point.trust = (landmark.inlier + 1.0) / (landmark.inlier + 2.0 * landmark.outlier + 1.0);
    points_.push_back(point);
  }
  if (points_.size() < kLeastCoarse) return false;
  fit_pose(camera, points_, pose, {.tukey = 4, .first_width = 16, .steps = 12}, fit_);
  if (!fit_.solved || fit_.inliers < kCoarseInliers) return false;
  pose = fit_.camera_from_world;
  return true;
}

// Finds the candidates in the finest images in which the smear leaves enough texture.
void PoseSearch::find_candidates(const LandmarkSearch& search, const TrackerFrame& frame) {
  int finest = 0;
  while (finest < 2 && smear_px_ > kSmearPerLevel * (1 << finest)) ++finest;
  points_.clear();
  point_candidate_.clear();
  tried_ = static_cast<int>(candidates_.size());
  for (int i = 0; i < tried_; ++i) {
    const Candidate& candidate = candidates_[i];
    Eigen::Vector2d uv;
    int level = 0;
    if (!search.find(candidate, finest + 1, finest, LandmarkSearch::kFineLikeness, uv, level)) {
      continue;
    }
    const Landmark& landmark = search.map.landmarks[candidate.landmark];
    PosePoint point;
    point.x_in_world = landmark.x_in_world;
    point.seen = search.sighting_of(frame, candidate, uv, level);
    // A new landmark may lie on something that moves, so its trust grows gradually.
    const double age = std::min(1.0, landmark.inlier / kFullyTrusted);
    point.trust = (0.4 + 0.6 * age) * (landmark.inlier + 1.0) /
                  (landmark.inlier + 2.0 * landmark.outlier + 1.0);
    points_.push_back(point);
    point_candidate_.push_back(i);
  }
}

void PoseSearch::rate_landmarks(std::vector<Landmark>& landmarks, int frame_count) {
  was_found_.assign(candidates_.size(), 0);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const int c = point_candidate_[i];
    was_found_[c] = 1;
    Landmark& landmark = landmarks[candidates_[c].landmark];
    if (fit_.inlier[i] != 0) {
      ++landmark.inlier;
      landmark.last_frame = frame_count;
    } else {
      ++landmark.outlier;
      if (landmark.outlier > kMostOutliers && 2 * landmark.outlier > landmark.inlier) {
        landmark.alive = false;
      }
    }
  }
  if (is_blurred()) return;  // landmarks may be missing because of the smear
  for (std::size_t c = 0; c < candidates_.size(); ++c) {
    if (was_found_[c] != 0) continue;
    Landmark& landmark = landmarks[candidates_[c].landmark];
    ++landmark.missed;
    if (landmark.missed > kMostMissed && landmark.missed > kMissedPerInlier * landmark.inlier) {
      landmark.alive = false;
    }
  }
}

void PoseSearch::clear() {
  points_.clear();
  point_candidate_.clear();
  fit_.inlier.clear();
  fit_.inliers = 0;
}

}  // namespace palpable
