/// @file
/// The landmarks that a new keyframe adds to the map: corners where the picture has none yet.
///
///     corner -> do its two measured depths agree? -> is an old landmark expected there?
///                                                      found: the keyframe has seen that one
///                                                      not found: the old one is removed
///                                                    -> the corner becomes a landmark
#pragma once

#include "palpable/live/track/new_corners.h"
#include "palpable/live/track/pose_search.h"

#include <optional>
#include <vector>

namespace palpable {

/// A keyframe adds as many corners as it needs to have TrackerSettings::most_landmarks plus this
/// many landmarks.
inline constexpr int kNewLandmarks = 60;

class NewLandmarks {
 public:
  /// Adds landmarks to the map's newest keyframe.
  /// @param search       in the keyframe's picture; its map is `map`
  /// @param seen         the search that found the keyframe's pose; no corners are placed in the
  ///                     cells of its inliers
  /// @param frame_count  frames so far
  void add(const LandmarkSearch& search, const TrackerFrame& frame, const PoseSearch& seen,
           int frame_count, LandmarkMap& map);

 private:
  void find_unseen(const LandmarkSearch& search, const TrackerFrame& frame, const PoseSearch& seen,
                   const Keyframe& keyframe);
  bool is_old_landmark(const LandmarkSearch& search, const TrackerFrame& frame,
                       const Eigen::Vector3d& uvd, int frame_count, LandmarkMap& map);
  [[nodiscard]] static Landmark landmark_at(const LandmarkSearch& search, const TrackerFrame& frame,
                                            const Corner& corner, double disparity,
                                            const LandmarkMap& map);

  // Landmarks that should be visible in the keyframe and are no inliers of its pose.
  std::vector<Candidate> unseen_;
};

}  // namespace palpable
