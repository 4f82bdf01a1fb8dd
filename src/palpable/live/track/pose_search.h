/// @file
/// Finds the camera's pose in one frame: selects the landmarks that should be visible, finds them
/// in the picture, and fits the pose that agrees with most of them.
#pragma once

#include "palpable/live/track/landmark_search.h"
#include "palpable/live/track/pose_fit.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace palpable {

/// The initial guess and the parameters of a search.
struct PoseQuery {
  Rigid3 guess = Rigid3::Identity();     ///< camera_from_world
  Rigid3 previous = Rigid3::Identity();  ///< camera_from_world one frame ago, for the smear
  /// true: search first in small images, with up to 64 landmarks, which are found up to 48 px from
  /// their predicted positions. false: the guess is accurate to a few pixels.
  bool coarse_first = true;
  int least_inliers = 0;  ///< landmarks that must agree
  double exposure = 0;    ///< share of the frame time during which the shutter is open
  int frame_count = 0;    ///< frames so far: landmarks that agreed recently have priority
};

/// Finds the pose, and keeps the landmarks that agreed with it. Does not allocate after its
/// construction, unless pictures are higher than wide.
class PoseSearch {
 public:
  explicit PoseSearch(const TrackerSettings& settings);

  /// camera_from_world, or nothing if too few landmarks are found or they disagree.
  [[nodiscard]] std::optional<Rigid3> find(const LandmarkSearch& search, const TrackerFrame& frame,
                                           const PoseQuery& query);

  // The following describe the last find().

  [[nodiscard]] int tried() const { return tried_; }  ///< landmarks that were searched
  [[nodiscard]] int inliers() const { return fit_.inliers; }
  /// Length of the picture's smear, px: the median over the landmarks that were searched.
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

  /// Updates the counts of each landmark: agreed, found elsewhere, or not found. Marks landmarks
  /// that mostly disagree as dead: they lie on something that moves, or their look has changed.
  void rate_landmarks(std::vector<Landmark>& landmarks, int frame_count);

  /// Resets the result of the last find(): no landmark agrees.
  void clear();

 private:
  static constexpr double kBlurredPx = 4;  // smear above which landmarks may be missed

  void select(const LandmarkSearch& search, const TrackerFrame& frame, const Rigid3& pose,
              const PoseQuery& query);
  bool improve_coarsely(const LandmarkSearch& search, const TrackerFrame& frame,
                        const PoseQuery& query, Rigid3& pose);
  void find_candidates(const LandmarkSearch& search, const TrackerFrame& frame);

  std::vector<Candidate> candidates_;  // landmarks that should be visible, the best first
  std::vector<PosePoint> points_;      // those of them that were found
  std::vector<int> point_candidate_;   // (points_) index into candidates_
  PoseFit fit_;                        // of points_
  int tried_ = 0;
  double smear_px_ = 0;
  // Work space, so that a frame does not allocate.
  std::vector<double> smears_;
  std::vector<char> was_found_;  // (candidates_)
  std::vector<int> cells_;
};

}  // namespace palpable
