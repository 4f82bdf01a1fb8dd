/// @file
/// The last keyframes and their points, adjusted together (bundle.h) while the camera goes on: what
/// is taken out of the map for it, and how the result comes back.
#pragma once

#include "palpable/track/bundle.h"
#include "palpable/track/landmark_map.h"

#include <optional>
#include <utility>
#include <vector>

namespace palpable {

/// Keyframes that are adjusted.
inline constexpr int kWindow = 7;

/// A part of the map. Plain data, so that any thread may work on it while the map is used.
struct Window {
  BundleProblem problem;
  std::vector<int> keyframes;            ///< of problem.camera_from_world
  std::vector<int> landmarks;            ///< of problem.x_in_world
  std::vector<std::pair<int, int>> bad;  ///< (landmark, keyframe) of sightings to drop
};

/// The last kWindow keyframes and all points that two of them have seen, with up to 5 older
/// keyframes that share the most points and are held.
[[nodiscard]] Window window_of(const TrackCamera& camera, const std::vector<Keyframe>& keyframes,
                               const std::vector<Landmark>& landmarks);

/// Adjusts it, and notes the sightings that do not agree.
void adjust(Window& window);

/// Into the map that it was taken from: no keyframe may have come or gone since. Points that one
/// keyframe alone has seen go with it.
void put_back(const Window& window, std::vector<Keyframe>& keyframes,
              std::vector<Landmark>& landmarks);

/// Points whose anchor has moved go with it, where `done` does not say (of landmarks, 1) that they
/// are placed already. @param world_from_old_world  of each keyframe that has moved
void move_points(const std::vector<std::optional<Rigid3>>& world_from_old_world,
                 const std::vector<char>& done, const std::vector<Keyframe>& keyframes,
                 std::vector<Landmark>& landmarks);

}  // namespace palpable
