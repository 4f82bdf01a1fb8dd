/// @file
/// Reads and sees the next frames on a thread while the present one is answered and drawn.
///
///     free scenes ──> VisionThread: read, see ──> queue of one ──> next(): respond, draw ──┐
///          ^                                                                               │
///          └────────────────────────────── recycle() <─────────────────────────────────────┘
///
/// A source that is silent or gone does not hold up the thread that answers: next_within() returns
/// without a frame, and the answer to the last one can stay on the screen.
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

/// One frame on its way through the loop. When it is done it is handed back with recycle(), and its
/// memory is used for a later frame.
struct FrameInFlight {
  Frame frame;  ///< as it was read
  Scene scene;  ///< `seen` is filled, and `times` has "read" and the stages of seeing
  /// When it was taken, s of system_clock(); else, and where a camera's clock is another one, when
  /// it had been read.
  double taken = 0;
};

/// Frames are seen in their order and by one thread, so the results are those of a loop on a single
/// thread, to the bit.
class VisionThread {
 public:
  /// @param source, camera  must outlive this; only the thread uses them until then
  /// @param frames          ends after so many; negative: at the source's end
  VisionThread(FrameSource& source, DepthCamera& camera, int frames);
  VisionThread(const VisionThread&) = delete;
  VisionThread& operator=(const VisionThread&) = delete;
  ~VisionThread();

  /// The next frame, or null at the end. Rethrows what went wrong on the thread.
  std::unique_ptr<FrameInFlight> next();
  /// The same, but waits at most so long: null then, too. ended() tells the two apart.
  std::unique_ptr<FrameInFlight> next_within(double seconds);
  /// Whether no frame comes any more. Rethrows what went wrong on the thread.
  [[nodiscard]] bool ended();
  /// Gives a frame's memory back.
  void recycle(std::unique_ptr<FrameInFlight> frame);

  /// What went wrong with the source since the last call, a line each.
  [[nodiscard]] std::vector<std::string> take_reports();
  /// The same, counted from the beginning.
  [[nodiscard]] SourceTroubles troubles();
  /// Why the last unusable frame could not be used.
  [[nodiscard]] std::string last_trouble();

 private:
  void run(FrameSource& source, DepthCamera& camera, int frames);
  void copy_reports(SourceGuard& guard);
  std::unique_ptr<FrameInFlight> frame_or_null(std::optional<std::unique_ptr<FrameInFlight>> item);

  BoundedQueue<std::unique_ptr<FrameInFlight>> ready_;
  BoundedQueue<std::unique_ptr<FrameInFlight>> free_;
  std::exception_ptr trouble_;  // read after ready_ is closed
  std::mutex reports_mutex_;    // guards what follows
  SourceTroubles troubles_;
  std::string last_trouble_;
  std::vector<std::string> reports_;
  std::thread thread_;
};

}  // namespace palpable
