/// @file
/// Reads and sees the next frames while the present one is answered and drawn.
///
/// Whatever the source does, it cannot hold up whoever answers: next_within() comes back without a
/// frame, and the last state is held.
#pragma once

#include "apps/palpable/bounded_queue.h"
#include "palpable/base/stage_clock.h"
#include "palpable/session/session.h"
#include "palpable/sources/frame_source.h"
#include "palpable/sources/source_guard.h"

#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

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
  /// The next frame; null when none came within `seconds`, and at the end, which ended() tells.
  std::unique_ptr<FrameInFlight> next_within(double seconds);
  /// No frame comes any more. Rethrows what went wrong on the thread.
  [[nodiscard]] bool ended();
  /// Gives a frame's memory back.
  void recycle(std::unique_ptr<FrameInFlight> frame);

  /// What the source did since the last call that it should not have, a line each.
  [[nodiscard]] std::vector<std::string> take_reports();
  /// The same, counted from the beginning.
  [[nodiscard]] SourceTroubles troubles();
  /// Why the last frame was unusable.
  [[nodiscard]] std::string last_trouble();

 private:
  void run(FrameSource& source, Session& session, int frames);
  void tell(SourceGuard& guard);
  std::unique_ptr<FrameInFlight> given(std::optional<std::unique_ptr<FrameInFlight>> item);

  BoundedQueue<std::unique_ptr<FrameInFlight>> ready_;
  BoundedQueue<std::unique_ptr<FrameInFlight>> free_;
  std::exception_ptr trouble_;  // read after ready_ is closed
  std::mutex told_mutex_;
  SourceTroubles troubles_;
  std::string last_trouble_;
  std::vector<std::string> reports_;
  std::thread thread_;
};

}  // namespace palpable::app
