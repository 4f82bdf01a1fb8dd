/// @file
/// Closing a loop: a camera that comes back after a long way has drifted so far that it finds none
/// of its old landmarks where they should be. The old keyframe is recognised by its picture, and
/// the drift is shared among all keyframes between.
///
///     truth     0 --- 1 --- 2 --- 3            recognised: 6 shows what 0 shows
///               |                 |            tie 6 to 0, adjust all poses,
///               6 --- 5 --- 4 ----+            and 6 lies beside 0 again
///
/// World: as the tracker has it. "Drifted" is what was believed before a loop was closed.
#pragma once

#include "palpable/common/geometry/correction.h"
#include "palpable/live/track/landmark_map.h"
#include "palpable/live/track/pose_graph.h"
#include "palpable/live/track/recogniser.h"

#include <optional>
#include <vector>

namespace palpable {

/// An old keyframe that was recognised in the newest one.
struct Loop {
  int old_number = 0;  ///< frame number of the old one; indices change when the map forgets
  int new_number = 0;  ///< frame number of the newer one
  Recognised new_from_old;
};

/// Keyframes that may show the same as the newest one although they share fewer than 5 landmarks
/// with it: at most `most`, those whose pictures are most like its picture first. Keyframes that
/// are still being adjusted (kWindow) are left out.
[[nodiscard]] std::vector<int> loop_candidates(const LandmarkMap& map, int most);

/// Where the loop says that the newer keyframe's camera stands: camera_from_world. Nothing when one
/// of the two was forgotten, or when that is farther off than drift can be, which is taken as a
/// tenth of the way and of the turn (at the median depth) between them: such a loop is a mistake of
/// the recogniser.
[[nodiscard]] std::optional<Rigid3> pose_by(const Loop& loop,
                                            const std::vector<Keyframe>& keyframes);

/// All keyframes, tied to each other by the landmarks that they share, and by the loop. n shared
/// landmarks, or n agreeing features, say how two cameras stand to each other to 1 / sqrt(n) px at
/// their median depth. Nothing when one of the loop's two keyframes was forgotten.
[[nodiscard]] std::optional<PoseGraph> graph_of(const TrackCamera& camera, const LandmarkMap& map,
                                                const Loop& loop);

/// Writes the graph's poses into the map; each landmark moves with its anchor.
void put_back(const PoseGraph& graph, LandmarkMap& map);

/// Gives up the landmarks that were first seen by the window's keyframes and lie in the picture of
/// the loop's old keyframe: the map holds that ground already, and knows it better.
void forget_doubles(const TrackCamera& camera, const Loop& loop, LandmarkMap& map);

/// Closes a loop with its adjusted graph: put_back() and forget_doubles().
/// @return how each keyframe was moved
[[nodiscard]] std::vector<Correction> close_loop(const TrackCamera& camera, const Loop& loop,
                                                 const PoseGraph& adjusted, LandmarkMap& map);

/// Believes a loop when two keyframes in turn say the same: a single one may look like another
/// place by chance, and a loop closed wrongly bends the whole map.
class LoopConfirmation {
 public:
  /// Compares what was recognised in the newest keyframe, if anything, with what was in the one
  /// before. A loop that moves the picture by less than 20 px is not needed: old landmarks are
  /// found up to 48 px from where they are expected, without it.
  /// @param median_depth  m, of what the camera sees
  void compare(const std::optional<Loop>& loop, const TrackCamera& camera, double median_depth,
               const std::vector<Keyframe>& keyframes);

  /// The loop on which two keyframes agreed, once.
  [[nodiscard]] std::optional<Loop> take_confirmed();

  void clear();

 private:
  std::optional<Rigid3> drifted_from_world_;  // as the last keyframe's loop says
  std::optional<Loop> confirmed_;
};

}  // namespace palpable
