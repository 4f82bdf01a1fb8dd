/// @file
/// Closing a loop: when a camera returns after a long walk, its drift can be so large that it finds
/// none of its old landmarks at their predicted positions. The old keyframe is then recognised by
/// its picture, and the drift is distributed among all keyframes between.
///
///     truth     0 --- 1 --- 2 --- 3            recognised: 6 shows what 0 shows
///               |                 |            tie 6 to 0, adjust all poses,
///               6 --- 5 --- 4 ----+            and 6 lies beside 0 again
///
/// World frame: the tracker's. "Drifted" denotes poses before a loop was closed.
#pragma once

#include "palpable/common/geometry/rigid.h"
#include "palpable/live/track/landmark_map.h"
#include "palpable/live/track/pose_graph.h"
#include "palpable/live/track/recogniser.h"

#include <optional>
#include <vector>

namespace palpable {

/// An old keyframe that was recognised in the newest one.
struct Loop {
  int old_number = 0;  ///< frame number of the old one (indices change in make_room())
  int new_number = 0;  ///< frame number of the newer one
  Recognised new_from_old;
};

/// Keyframes that may show the same part of the scene as the newest one although they share fewer
/// than 5 landmarks with it: at most `most`, in falling order of their pictures' similarity.
/// Keyframes that are still being adjusted (kWindow) are left out.
[[nodiscard]] std::vector<int> loop_candidates(const LandmarkMap& map, int most);

/// The pose of the newer keyframe according to the loop: camera_from_world. Nothing if one of the
/// two keyframes was removed, or if the difference from the present pose is larger than plausible
/// drift; such a loop is an error of the recogniser. Plausible drift is a tenth of the path length
/// between the two, plus a tenth of the rotation angle times the median depth.
[[nodiscard]] std::optional<Rigid3> pose_by(const Loop& loop,
                                            const std::vector<Keyframe>& keyframes);

/// The pose graph of all keyframes. Its ties are pairs of keyframes that share landmarks, and the
/// loop. n shared landmarks, or n agreeing features, determine a relative pose with a standard
/// deviation of 1 / sqrt(n) px at the median depth. Nothing if one of the loop's two keyframes was
/// removed.
[[nodiscard]] std::optional<PoseGraph> graph_of(const TrackCamera& camera, const LandmarkMap& map,
                                                const Loop& loop);

/// Writes the graph's poses into the map; each landmark moves with its anchor.
void put_back(const PoseGraph& graph, LandmarkMap& map);

/// Removes the landmarks that were first seen by the window's keyframes and lie in the picture of
/// the loop's old keyframe: the map already contains that region, with more accurate landmarks.
void forget_doubles(const TrackCamera& camera, const Loop& loop, LandmarkMap& map);

/// Closes a loop with its adjusted graph: put_back() and forget_doubles().
/// @return the correction of each keyframe
[[nodiscard]] std::vector<Correction> close_loop(const TrackCamera& camera, const Loop& loop,
                                                 const PoseGraph& adjusted, LandmarkMap& map);

/// Confirms a loop when two successive keyframes agree on it. A single keyframe may resemble
/// another part of the scene by chance, and a wrongly closed loop distorts the whole map.
class LoopConfirmation {
 public:
  /// Compares the loop that was found for the newest keyframe, if any, with that of the keyframe
  /// before. A loop that moves the picture by less than 20 px is ignored, because old landmarks are
  /// found up to 48 px from their predicted positions without it.
  /// @param median_depth  m, of the scene in view
  void compare(const std::optional<Loop>& loop, const TrackCamera& camera, double median_depth,
               const std::vector<Keyframe>& keyframes);

  /// The loop on which two keyframes agreed; it is returned only once.
  [[nodiscard]] std::optional<Loop> take_confirmed();

  void clear();

 private:
  std::optional<Rigid3> drifted_from_world_;  // according to the last keyframe's loop
  std::optional<Loop> confirmed_;
};

}  // namespace palpable
