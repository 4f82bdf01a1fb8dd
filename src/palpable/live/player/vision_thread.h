/// @file
/// Reads and evaluates the next frames on a thread while the present one is processed and drawn.
///
///     free scenes ──> VisionThread: read, see ──> queue of one ──> next(): respond, draw ──┐
///          ^                                                                               │
///          └────────────────────────────── recycle() <─────────────────────────────────────┘
///
/// A silent or unplugged camera does not block the processing thread: next_within() returns without
/// a frame, and the last result can stay on the screen.
#pragma once

#include "palpable/live/depth/depth_camera.h"
#include "palpable/live/player/bounded_queue.h"
#include "palpable/live/session/scene.h"
#include "palpable/live/sources/frame_source.h"
#include "palpable/live/sources/source_guard.h"

#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace palpable {

/// One frame on its way through the loop. recycle() takes it back and reuses its memory
/// for a later frame.
struct FrameInFlight {
  Frame frame;  ///< as read from the source
  Scene scene;  ///< `seen` is filled, and `times` has "read" and the stages of seeing
  /// s of system_clock(): the time at which the frame was taken; the time at which it was read if
  /// the source does not state it or uses another clock.
  double taken = 0;
};

/// Problems of a run's source.
struct SourceReports {
  std::vector<std::string> lines;  ///< messages, one line each
  SourceTroubles troubles;         ///< counted from the beginning
  std::string last_trouble;        ///< the reason why the last unusable frame was skipped
};

/// One thread evaluates the frames in their order, so that the results are bit-identical to those
/// of a loop on a single thread.
class VisionThread {
 public:
  /// @param source, camera  must outlive this; until then only this thread uses them
  /// @param frames          largest number of frames; negative: up to the source's end
  VisionThread(FrameSource& source, DepthCamera& camera, int frames);
  VisionThread(const VisionThread&) = delete;
  VisionThread& operator=(const VisionThread&) = delete;
  ~VisionThread();

  /// The next frame, or null at the end. Rethrows exceptions of the thread.
  std::unique_ptr<FrameInFlight> next();
  /// The same with a time limit, after which it returns null, too; ended() tells the
  /// two cases apart.
  std::unique_ptr<FrameInFlight> next_within(double seconds);
  /// Whether no further frame will come. Rethrows exceptions of the thread.
  [[nodiscard]] bool ended();
  /// Returns a frame's memory for reuse.
  void recycle(std::unique_ptr<FrameInFlight> frame);

  /// The problems of the source. The next call returns only later lines.
  [[nodiscard]] SourceReports take_reports();

 private:
  void run(FrameSource& source, DepthCamera& camera, int frames);
  void copy_reports(SourceGuard& guard);
  std::unique_ptr<FrameInFlight> frame_or_null(std::optional<std::unique_ptr<FrameInFlight>> item);

  BoundedQueue<std::unique_ptr<FrameInFlight>> ready_;
  BoundedQueue<std::unique_ptr<FrameInFlight>> free_;
  std::exception_ptr trouble_;  // read only after ready_ is closed
  std::mutex reports_mutex_;    // guards reports_
  SourceReports reports_;
  std::thread thread_;
};

}  // namespace palpable
