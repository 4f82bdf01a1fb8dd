/// @file
/// The landmarks that a new keyframe brings into the map: corners where the picture has none yet.
///
///     corner -> is its depth measured twice alike? -> is an old landmark expected there?
///                                                       found: the keyframe has seen that one
///                                                       not found: it is given up
///                                                     -> the corner becomes a landmark
#pragma once

#include "palpable/live/track/new_corners.h"
#include "palpable/live/track/pose_search.h"

#include <optional>
#include <vector>

namespace palpable {

/// Corners that a keyframe can bring beyond TrackerSettings::most_landmarks that carried it.
inline constexpr int kNewLandmarks = 60;

class NewLandmarks {
 public:
  /// Adds landmarks to the map's newest keyframe.
  /// @param search       in the keyframe's picture; its map is `map`
  /// @param seen         the landmarks that carried the keyframe's pose: where they are no corner
  ///                     is looked for
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

  // Landmarks that should be seen in the keyframe and did not carry it.
  std::vector<Candidate> unseen_;
};

}  // namespace palpable
