/// @file
/// The last keyframes and their landmarks, adjusted together (bundle.h) while the camera goes on:
/// a copy of that part of the map is taken out, adjusted on any thread, and put back.
#pragma once

#include "palpable/live/track/bundle.h"
#include "palpable/live/track/landmark_map.h"

#include <optional>
#include <utility>
#include <vector>

namespace palpable {

/// How many of the last keyframes are adjusted.
inline constexpr int kWindow = 7;

/// A part of the map. Plain data, so that another thread may adjust it while the map is used.
struct AdjustmentWindow {
  BundleProblem problem;
  std::vector<int> keyframes;            ///< index in the map, of problem.camera_from_world
  std::vector<int> landmarks;            ///< index in the map, of problem.x_in_world
  std::vector<std::pair<int, int>> bad;  ///< (landmark, keyframe) of sightings to drop
};

/// The last kWindow keyframes and all landmarks that two of them have seen, with up to 5 older
/// keyframes that share the most landmarks with them. The older ones are held fixed: they tie the
/// window to the world.
[[nodiscard]] AdjustmentWindow window_of(const TrackCamera& camera, const LandmarkMap& map);

/// Adjusts it, and enters the sightings that do not agree in `bad`.
void adjust(AdjustmentWindow& window);

/// Writes the result into the map that the window was taken from; no keyframe may have come or gone
/// since. A landmark outside of the window keeps its place in its anchor's picture: it is moved as
/// its anchor was.
void put_back(const AdjustmentWindow& window, LandmarkMap& map);

/// Moves the landmarks whose anchor has moved, as it was moved.
/// @param world_from_old_world  (keyframes) of each one that has moved; nothing: it has not
/// @param placed  (landmarks) 1: has its place already and is not moved
void move_landmarks(const std::vector<std::optional<Rigid3>>& world_from_old_world,
                    const std::vector<char>& placed, LandmarkMap& map);

}  // namespace palpable
