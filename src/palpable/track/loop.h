/// @file
/// A camera that comes back with so much drift that it finds none of its old landmarks where they
/// should be: the old keyframe is recognised, and the drift is shared among all keyframes between.
#pragma once

#include "palpable/track/landmark_map.h"
#include "palpable/track/pose_graph.h"
#include "palpable/track/recogniser.h"

#include <optional>
#include <vector>

namespace palpable {

/// A keyframe that was recognised in the newest one.
struct Loop {
  int old_number = 0;  ///< frame number of the one; indices change when the map makes room
  int new_number = 0;
  Recognised new_from_old;
};

/// Keyframes that look most like the newest and share hardly a landmark with it, at most `most`,
/// the most alike first. Those of the window are not among them.
[[nodiscard]] std::vector<int> loop_candidates(const std::vector<Keyframe>& keyframes,
                                               const std::vector<Landmark>& landmarks, int most);

/// Where the camera of the newer keyframe would stand by the loop, in the world of the older one;
/// nothing when either is no longer kept, or when it is off by more than drift can be: a tenth of
/// the way and of the turn (at the median depth) between them.
[[nodiscard]] std::optional<Rigid3> pose_by(const Loop& loop,
                                            const std::vector<Keyframe>& keyframes);

/// All keyframes, tied by the landmarks that they share and by the loop: each shared landmark (or
/// feature that agreed) says how two cameras stand to a pixel, at their median depth. Nothing when
/// one of the loop's two is no longer kept.
[[nodiscard]] std::optional<PoseGraph> graph_of(const TrackCamera& camera,
                                                const std::vector<Keyframe>& keyframes,
                                                const std::vector<Landmark>& landmarks,
                                                const Loop& loop);

/// The graph's poses into the map; each landmark goes with the keyframe that saw it first.
void put_back(const PoseGraph& graph, std::vector<Keyframe>& keyframes,
              std::vector<Landmark>& landmarks);

/// Gives up the landmarks that the window's keyframes saw first and that lie in the picture of the
/// loop's older keyframe: what is seen there is in the map already, and better placed.
void forget_doubles(const TrackCamera& camera, const Loop& loop,
                    const std::vector<Keyframe>& keyframes, std::vector<Landmark>& landmarks);

}  // namespace palpable
