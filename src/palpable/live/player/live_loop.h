/// @file
/// The frame loop of a run: returns the scenes of a run one after the other, while another thread
/// reads and evaluates the next frame.
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
  /// @param run     must outlive this; until then only the loop uses its source and camera
  /// @param frames  largest number of frames; negative: up to the source's end
  /// @param report  receives messages about the source, and the reason when refinement ends, line
  ///                by line, on the thread that calls the functions below
  explicit LiveLoop(LiveRun& run, int frames = -1,
                    std::function<void(const std::string& line)> report = {});

  /// Waits for the next frame and processes it; null at the end.
  ///
  /// The scene belongs to the caller until the next call. To keep it, the caller may swap it with
  /// another one (an earlier scene, whose memory is then reused).
  /// @throws Error when a stereo pair does not fit its calibration, naming the images; and
  /// exceptions of the reading thread
  Scene* next();

  /// The same with a time limit, after which it returns null, too; ended() tells the
  /// two cases apart.
  Scene* next_within(double seconds);

  /// The time at which the last scene's frame was taken (FrameInFlight::taken).
  [[nodiscard]] double taken() const { return flight_->taken; }

  /// Whether no further frame will come.
  [[nodiscard]] bool ended();

  /// Total number of frames if it is known beforehand; else 0 or less.
  [[nodiscard]] int total() const { return total_; }

  /// Stops reading, lets `change` replace the source or the camera of the run, and continues with
  /// the source's next frame. Frames that were read but not processed, at most three, are dropped.
  /// The caller must not use a scene at that time.
  /// @throws exceptions of `change`; the loop continues in that case, too
  void begin_anew(const std::function<void(LiveRun&)>& change);

  /// The run has ended: passes what a short run has shown of its depths to `report`.
  void finish();

  /// The events up to now. Passes the source's new messages to `report`.
  const LiveCounts& counts();

 private:
  void begin_seeing();
  Scene* process(std::unique_ptr<FrameInFlight> flight);
  void report(std::string line);
  void report_depth();
  void recycle();

  LiveRun& run_;
  int total_;
  std::function<void(const std::string&)> report_;
  LiveCounts counts_;
  int frames_;                      // at most; negative: all
  SourceTroubles troubles_before_;  // of vision threads that have ended
  std::optional<VisionThread> vision_;
  std::unique_ptr<FrameInFlight> flight_;  // the frame whose scene the caller has
};

}  // namespace palpable
