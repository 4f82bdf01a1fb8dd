/// @file
/// The camera's pose in one frame: which landmarks should be seen, where they are found, and the
/// pose that agrees with most of them.
#pragma once

#include "palpable/live/track/landmark_search.h"
#include "palpable/live/track/pose_fit.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace palpable {

/// Where a pose is looked for, and how.
struct PoseQuery {
  Rigid3 guess = Rigid3::Identity();     ///< camera_from_world
  Rigid3 previous = Rigid3::Identity();  ///< camera_from_world one frame ago, for the smear
  /// true: first in small images, by up to 64 landmarks, found up to 48 px from where the guess
  /// expects them. false: the guess is good to a few pixels.
  bool coarse_first = true;
  int least_inliers = 0;  ///< landmarks that must agree
  double exposure = 0;    ///< share of the frame time that the shutter is open
  int frame_count = 0;    ///< frames so far: a landmark that agreed a moment ago is tried first
};

/// Finds the pose, and keeps the landmarks that agreed with it. Allocates nothing after its
/// construction, unless pictures are higher than wide.
class PoseSearch {
 public:
  explicit PoseSearch(const TrackerSettings& settings);

  /// camera_from_world, or nothing when too few landmarks are found or they disagree.
  [[nodiscard]] std::optional<Rigid3> find(const LandmarkSearch& search, const TrackerFrame& frame,
                                           const PoseQuery& query);

  // The following describe the last find().

  [[nodiscard]] int tried() const { return tried_; }  ///< landmarks that were looked for
  [[nodiscard]] int inliers() const { return fit_.inliers; }
  /// Median over the landmarks that were looked for, px: how far the picture is smeared.
  [[nodiscard]] double smear_px() const { return smear_px_; }
  /// Whether the smear is so large that landmarks may be missed because of it.
  [[nodiscard]] bool is_blurred() const { return smear_px_ > kBlurredPx; }

  /// Calls visit(const Candidate&, const PosePoint&) with each landmark that agreed with the pose.
  template <class Visit>
  void for_each_inlier(const Visit& visit) const {
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (fit_.inlier[i] != 0) visit(candidates_[point_candidate_[i]], points_[i]);
    }
  }

  /// Counts in each landmark whether it agreed, was found elsewhere or was not found. Gives up
  /// landmarks that mostly do not agree: they lie on something that moves, or have changed their
  /// look.
  void rate_landmarks(std::vector<Landmark>& landmarks, int frame_count);

  /// Forgets the last find(): no landmark agrees.
  void clear();

 private:
  static constexpr double kBlurredPx = 4;

  void select(const LandmarkSearch& search, const TrackerFrame& frame, const Rigid3& pose,
              const PoseQuery& query);
  bool improve_coarsely(const LandmarkSearch& search, const TrackerFrame& frame,
                        const PoseQuery& query, Rigid3& pose);
  void find_candidates(const LandmarkSearch& search, const TrackerFrame& frame);

  TrackCamera camera_;
  std::vector<Candidate> candidates_;  // that should be seen, the best first
  std::vector<PosePoint> points_;      // those of them that were found
  std::vector<int> point_candidate_;   // (points_) index into candidates_
  PoseFit fit_;                        // of points_
  int tried_ = 0;
  double smear_px_ = 0;
  // Room to work in, so that a frame takes no memory.
  std::vector<double> smears_;
  std::vector<char> was_found_;  // (candidates_)
  std::vector<int> cells_;
};

}  // namespace palpable
