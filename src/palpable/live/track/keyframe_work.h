/// @file
/// What is computed beside the frames after a keyframe was kept: its features, the adjustment of
/// the last keyframes or of a closed loop, and whether an old keyframe is recognised in it.
///
///     frame n      keyframe kept --begin()--> thread: adjust, find features, recognise
///     frame n + 3  finish() waits for it, and the tracker puts the result into its map
///
/// The result is always used three frames later, however fast the thread was: so the same frames
/// give the same poses to the bit.
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
  // What is asked for, copied from the map.
  int number = 0;                          ///< frame number of the newest keyframe
  GrayImage image;                         ///< its picture at half size, for its features
  DepthImage depth;                        ///< of the same view, of any size
  PinholeCamera camera;                    ///< of `image`
  std::optional<AdjustmentWindow> window;  ///< to be adjusted
  std::optional<PoseGraph> graph;          ///< to be adjusted instead of the window,
  std::optional<Loop> closing;             ///< when this loop is closed
  /// Old keyframes that may be recognised: frame numbers and features.
  std::vector<std::pair<int, Features>> candidates;

  // The result, beside the adjusted window or graph.
  Features features;             ///< of the newest keyframe
  bool graph_is_solved = false;  ///< false: the graph's poses are as they were
  std::optional<Loop> loop;      ///< the candidate that most features agree on
  double cpu_s = 0;              ///< of the thread that did it
  double cpu_s_of_caller = 0;    ///< of finish(), when no thread could be had
};

/// Copies what the work needs.
/// @param image_at_half_size  of the newest keyframe
/// @param closing  a loop to be closed, if its keyframes are still there
[[nodiscard]] KeyframeWork work_for_newest(const TrackerSettings& settings, const LandmarkMap& map,
                                           const GrayImage& image_at_half_size,
                                           const DepthImage& depth, std::optional<Loop> closing);

/// One piece of work at a time, on a thread of its own.
class KeyframeWorker {
 public:
  /// @param on_thread  false, or no thread to be had: it is done in finish(), with the same result
  void begin(KeyframeWork work, bool on_thread);
  [[nodiscard]] bool is_busy() const { return pending_.has_value(); }
  /// Waits for the result; only while busy.
  [[nodiscard]] KeyframeWork finish();
  /// Waits too, and forgets the result.
  void abandon() { pending_.reset(); }

 private:
  std::optional<std::future<KeyframeWork>> pending_;
  bool deferred_ = false;  // it is done by finish()
};

}  // namespace palpable
