/// @file
/// The last keyframes and their landmarks, which are adjusted together (bundle.h) while tracking
/// continues: a part of the map is copied, adjusted on any thread, and written back.
#pragma once

#include "palpable/live/track/bundle.h"
#include "palpable/live/track/disparity_watch.h"
#include "palpable/live/track/landmark_map.h"

#include <optional>
#include <utility>
#include <vector>

namespace palpable {

/// The number of newest keyframes that are adjusted.
inline constexpr int kWindow = 7;

/// A part of the map. Plain data, so that another thread may adjust it while the map is used.
struct AdjustmentWindow {
  BundleProblem problem;
  std::vector<int> keyframes;            ///< index in the map of each problem.camera_from_world
  std::vector<int> landmarks;            ///< index in the map of each problem.x_in_world
  std::vector<std::pair<int, int>> bad;  ///< (landmark, keyframe) of sightings to drop
  TrackCamera map_camera;  ///< with which the map's landmarks are placed; after adjust()
                           ///< problem.camera may have another disparity error
  std::optional<DisparityWatch> watch;  ///< decides on that; nothing: the error does not change
};

/// Copies the last kWindow keyframes, up to 5 older keyframes that share the most landmarks with
/// them, and the landmarks of the last kWindow keyframes that at least two of all these have seen.
/// The older keyframes are held fixed, which ties the window to the world frame.
[[nodiscard]] AdjustmentWindow window_of(const TrackCamera& camera, const LandmarkMap& map);

/// Adjusts the window, and lists the sightings that do not agree in `bad`. If the watch finds
/// another disparity error, the window is adjusted again with that.
void adjust(AdjustmentWindow& window);

/// Adjusts the window again with another disparity error. All its lengths change, so only its
/// oldest keyframe is held fixed: the others would hold the lengths back.
void adjust_with_error(AdjustmentWindow& window, double disparity_error_px);

/// Writes the result into the map from which the window was copied. No keyframe may have been added
/// or removed in between. A landmark that is not in the window moves together with its anchor, so
/// that its position in the anchor's picture does not change, nor its measured disparity there.
void put_back(const AdjustmentWindow& window, LandmarkMap& map);

/// Moves the landmarks whose anchor has moved together with the anchor.
/// @param world_from_old_world  (keyframes) the motion of each keyframe; nothing: it has not moved
/// @param placed  (landmarks) 1: its position is up to date and is not changed
void move_landmarks(const std::vector<std::optional<Rigid3>>& world_from_old_world,
                    const std::vector<char>& placed, LandmarkMap& map);

}  // namespace palpable
