/// @file
/// The background work for a new keyframe: it finds the keyframe's features, adjusts the last
/// keyframes or a closed loop, and tries to recognise an old keyframe.
///
///     frame n      keyframe kept --begin()--> thread: adjust, find features, recognise
///     frame n + 3  finish() waits for it, and the tracker puts the result into its map
///
/// The result is always used three frames later, however fast the thread was, so that the same
/// frames give the same poses to the bit.
#pragma once

#include "palpable/live/track/loop.h"
#include "palpable/live/track/window.h"

#include <future>
#include <optional>
#include <utility>
#include <vector>

namespace palpable {

struct TrackerSettings;

struct KeyframeWork {
  // The input, copied from the map.
  int number = 0;                          ///< frame number of the newest keyframe
  GrayImage image;                         ///< its picture at half size, for its features
  DepthImage depth;                        ///< of the same view, of any size
  PinholeCamera camera;                    ///< of `image`
  std::optional<AdjustmentWindow> window;  ///< to be adjusted, unless a loop is closed
  std::optional<PoseGraph> graph;          ///< to be adjusted if a loop is closed
  std::optional<Loop> closing;             ///< the loop that is closed
  /// Old keyframes that may be recognised: frame numbers and features.
  std::vector<std::pair<int, Features>> candidates;

  // The result, in addition to the adjusted window or graph.
  Features features;             ///< of the newest keyframe
  bool graph_is_solved = false;  ///< false: the graph's poses are unchanged
  std::optional<Loop> loop;      ///< to the candidate with the most agreeing features
  double cpu_s = 0;              ///< CPU time of the work
  double cpu_s_of_caller = 0;    ///< the part of it that finish() has used; 0 with a thread
};

/// Copies the input of the work from the map.
/// @param image_at_half_size  of the newest keyframe
/// @param closing  a loop to be closed; ignored if one of its keyframes was removed
/// @param watch  of the disparity error; nothing for a camera without disparities
[[nodiscard]] KeyframeWork work_for_newest(const TrackerSettings& settings, const LandmarkMap& map,
                                           const GrayImage& image_at_half_size,
                                           const DepthImage& depth, std::optional<Loop> closing,
                                           const std::optional<DisparityWatch>& watch);

/// Does one piece of work at a time, on a thread of its own.
class KeyframeWorker {
 public:
  /// @param on_thread  if false, or if no thread is available, finish() does the work, with the
  ///                   same result
  void begin(KeyframeWork work, bool on_thread);
  [[nodiscard]] bool is_busy() const { return pending_.has_value(); }
  /// Waits for the result.
  /// @pre is_busy()
  [[nodiscard]] KeyframeWork finish();
  /// Waits for the thread and discards the result.
  void abandon() { pending_.reset(); }

 private:
  std::optional<std::future<KeyframeWork>> pending_;
  bool deferred_ = false;  // whether finish() does the work
};

}  // namespace palpable
