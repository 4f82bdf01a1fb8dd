/// @file
/// Reads and sees the next frames while the present one is answered and drawn.
#pragma once

#include "apps/palpable/bounded_queue.h"
#include "palpable/base/stage_clock.h"
#include "palpable/session/session.h"
#include "palpable/vision/frame_source.h"

#include <exception>
#include <memory>
#include <thread>

namespace palpable::app {

/// One frame on its way through the loop; its memory goes round.
struct FrameInFlight {
  Frame frame;
  SeenFrame seen;
  StageTimes times;  ///< "read" and the stages of Session::see
};

/// The results are those of a loop without it: frames are seen in order, by one thread.
class VisionThread {
 public:
  /// @param frames   stops after so many; negative: at the source's end
  /// @param source, session  must outlive this; the source belongs to the thread until then
  VisionThread(FrameSource& source, Session& session, int frames);
  VisionThread(const VisionThread&) = delete;
  VisionThread& operator=(const VisionThread&) = delete;
  ~VisionThread();

  /// The next frame, or null at the end. Rethrows what went wrong on the thread.
  std::unique_ptr<FrameInFlight> next();
  /// Gives a frame's memory back.
  void recycle(std::unique_ptr<FrameInFlight> frame);

 private:
  void run(FrameSource& source, Session& session, int frames);

  BoundedQueue<std::unique_ptr<FrameInFlight>> ready_;
  BoundedQueue<std::unique_ptr<FrameInFlight>> free_;
  std::exception_ptr trouble_;  // read after ready_ is closed
  std::thread thread_;
};

}  // namespace palpable::app
