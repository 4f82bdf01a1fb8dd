/// @file
/// Contact at its own rate on its own thread: `rate` solutions per second between the camera's
/// frames (session/between_frames.h), for haptic devices and other programs that need touches more
/// often than pictures come.
///
///     tick j of frame n    predicts the state j / rate s after it, j = 1 .. rate * interval
///
/// The interval is the time between frames n - 1 and n. In a live run each tick is reported when it
/// is due, and ticks continue for up to two intervals if the next frame is late; ticks that are
/// pending when the next frame comes are dropped. In a run whose source waits for the loop, the
/// next frame waits for all ticks.
#pragma once

#include "palpable/live/player/run_stats.h"
#include "palpable/live/session/between_frames.h"
#include "palpable/live/session/scene.h"
#include "palpable/live/session/session.h"

#include <Eigen/Core>

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace palpable {

/// One tick. Its pointers are valid during the call of `report` only.
struct ContactTick {
  int frame = 0;                                ///< number of the frame before
  int number = 0;                               ///< of the tick, counted from 1
  double ahead = 0;                             ///< s after the frame
  double time = 0;                              ///< s, the frame's time + `ahead`
  const std::vector<Touch>* touches = nullptr;  ///< sorted by force, the largest first
};

/// Statistics of a run's ticks.
struct ContactTickFigures {
  std::uint64_t ticks = 0;
  std::uint64_t left_out = 0;     ///< dropped because the next frame came
  double p50_ms = 0, p99_ms = 0;  ///< computation of one tick with touches
  int frames = 0;                 ///< with touches and all ticks; the averages below are over them
  /// m, largest distance of a vertex from its position in the next frame: of the skin in the last
  /// tick, and of the skin in the frame before, which is the error without ticks.
  double off = 0, off_held = 0;
};

class ContactTicks {
 public:
  struct Settings {
    double rate = 1000;     ///< Hz, > 0
    bool when_due = false;  ///< true: for a camera. False: each frame waits for all its ticks
  };
  /// @pre BetweenFrames::trouble_of(session) returns nothing
  /// @param session  must outlive this
  /// @param report   called for every tick on the tick thread; may be empty
  ContactTicks(const Session& session, const Settings& settings,
               std::function<void(const ContactTick&)> report);
  ContactTicks(const ContactTicks&) = delete;
  ContactTicks& operator=(const ContactTicks&) = delete;
  ~ContactTicks();

  /// Ends the ticks of the previous frame; called after the next frame was processed, on the same
  /// thread. With when_due the pending ticks are dropped, else they are waited for.
  void end_frame();
  /// Starts the ticks of this frame.
  /// @pre end_frame() was called since the frame before
  void begin_frame(const Session& session, const Scene& scene);
  /// Waits for the last ticks and ends the thread.
  [[nodiscard]] ContactTickFigures finish();

 private:
  void run();
  void run_ticks();
  [[nodiscard]] bool is_due(double ahead, double begin);
  void compare(const SolvedFrame& next);

  Settings settings_;
  std::function<void(const ContactTick&)> report_;
  BetweenFrames between_;
  SolvedFrame taken_;  // filled by the caller's thread, then swapped with waiting_
  // Used by the tick thread only.
  SolvedFrame frame_;
  Eigen::Matrix3Xf skin_, skin_of_frame_, skin_at_end_;  // m
  bool reached_end_ = false;  // skin_at_end_ is valid: the skin at the time of the next frame
  double off_ = 0, off_held_ = 0;
  ContactTickFigures figures_;
  DurationBins times_;

  std::mutex mutex_;  // guards the members below
  std::condition_variable changed_;
  SolvedFrame waiting_;
  bool is_waiting_ = false, is_busy_ = false;  // waiting_ holds a frame; the tick thread computes
  bool cuts_ = false;                          // the pending ticks of the frame are to be dropped
  bool ends_ = false;
  std::thread thread_;  // last, as it uses the other members
};

/// A readable line: number of ticks, time per tick and error.
[[nodiscard]] std::string text_of(const ContactTickFigures& figures);

}  // namespace palpable
