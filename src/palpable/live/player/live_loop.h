/// @file
/// The run loop: gives a run's scenes one after the other, each answered, while the next frame is
/// being read and seen on another thread.
#pragma once

#include "palpable/live/player/live_counts.h"
#include "palpable/live/player/live_run.h"
#include "palpable/live/player/vision_thread.h"
#include "palpable/live/session/scene.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace palpable {

class LiveLoop {
 public:
  /// @param run     must outlive this; its source and its camera belong to the loop until then
  /// @param frames  at most so many; negative: up to the source's end
  /// @param report  gets what the source reports of its troubles, and why nothing is refined any
  ///                more, line by line, on the thread that calls the functions below
  explicit LiveLoop(LiveRun& run, int frames = -1,
                    std::function<void(const std::string& line)> report = {});

  /// Waits for the next frame and answers it; null at the end.
  ///
  /// The scene is the caller's until the next call, who may also swap it for another one to keep it
  /// (a former scene, whose memory is then used again).
  /// @throws Error when a stereo pair does not fit its calibration, naming the images; and what
  /// went wrong on the thread that reads
  Scene* next();

  /// The same, but waits at most so long: null then, too. ended() tells the two apart.
  Scene* next_within(double seconds);

  /// When the frame of the scene given last was taken (FrameInFlight::taken).
  [[nodiscard]] double taken() const { return flight_->taken; }

  /// Whether no frame comes any more.
  [[nodiscard]] bool ended();

  /// Frames that come in all, as far as that is known beforehand; else 0 or less.
  [[nodiscard]] int total() const { return total_; }

  /// Ends reading and seeing, lets `change` put another source or camera into the run, and goes on
  /// with the source's next frame. Those that were read and not answered (at most three) are left
  /// out. Not while the caller uses a scene.
  /// @throws what `change` throws, with which the loop goes on all the same
  void begin_anew(const std::function<void(LiveRun&)>& change);

  /// What happened up to now. Reports what the source has said since the last call.
  const LiveCounts& counts();

 private:
  void begin_seeing();
  Scene* answer(std::unique_ptr<FrameInFlight> flight);
  void report_refiner();
  void recycle();

  LiveRun& run_;
  int total_;
  std::function<void(const std::string&)> report_;
  LiveCounts counts_;
  int frames_;                      // at most; negative: all
  SourceTroubles troubles_before_;  // of threads that have ended
  std::optional<VisionThread> vision_;
  std::unique_ptr<FrameInFlight> flight_;  // whose scene the caller has
};

}  // namespace palpable
