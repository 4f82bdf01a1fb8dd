/// @file
/// Contact at a rate of its own, on a thread of its own: `rate` answers a second between the
/// camera's frames (session/between_frames.h), for haptic devices and whoever else cannot wait for
/// a picture.
///
///     tick j of frame n    answers j / rate s after it, j = 1 .. rate * interval
///
/// interval: between frame n - 1 and frame n. Who plays live is told each tick when it is due, and
/// ticks go on for up to two intervals where the next frame is late; what is left of a frame's
/// ticks when it comes is left out. Where frames wait for the loop, the next frame waits for all
/// ticks.
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

/// One answer between frames. What it points to is the thread's, during the call alone.
struct ContactTick {
  int frame = 0;                                ///< after which
  int number = 0;                               ///< of the tick, from 1 on
  double ahead = 0;                             ///< s after the frame
  double time = 0;                              ///< s, the frame's and `ahead`
  const std::vector<Touch>* touches = nullptr;  ///< the strongest first
  const Eigen::Matrix3Xf* skin = nullptr;       ///< (3 x F) m, body frame
};

/// What became of a run's ticks.
struct ContactTickFigures {
  std::uint64_t ticks = 0;
  std::uint64_t left_out = 0;     ///< not made in time before the next frame
  double p50_ms = 0, p99_ms = 0;  ///< that one takes while touched: contact and the skin's shape
  int frames = 0;  ///< touched, and told until the next one came; of these, on average:
  /// m, farthest way of a vertex between where the last tick had the skin and where the next frame
  /// found it; and between the two frames, which is what without ticks it would be off by.
  double off = 0, off_held = 0;
};

class ContactTicks {
 public:
  struct Settings {
    double rate = 1000;     ///< Hz, of ticks; above 0
    bool when_due = false;  ///< a camera's; else each frame waits until its ticks are told
  };
  /// @pre BetweenFrames::trouble_of(session) has none
  /// @param session  outlives this
  /// @param tell     called for every tick, on the thread; may be empty
  ContactTicks(const Session& session, const Settings& settings,
               std::function<void(const ContactTick&)> tell);
  ContactTicks(const ContactTicks&) = delete;
  ContactTicks& operator=(const ContactTicks&) = delete;
  ~ContactTicks();

  /// Once the next frame is answered, on the thread that answers it: the ticks of the frame before
  /// end. Those that are due when they are made are left out from here on, others are waited for.
  void end_frame();
  /// From here on ticks are those of this frame.
  /// @pre end_frame() was called since the frame before
  void begin_frame(const Session& session, const Scene& scene);
  /// Waits for the last ticks; there are none from then on.
  [[nodiscard]] ContactTickFigures finish();

 private:
  void run();
  void answer_frame();
  [[nodiscard]] bool is_due(double ahead, double begin);
  void compare(const SolvedFrame& next);

  Settings settings_;
  std::function<void(const ContactTick&)> tell_;
  BetweenFrames between_;
  SolvedFrame taken_;  // filled by the thread that answers frames, then swapped in
  // Of the thread.
  SolvedFrame frame_;
  Eigen::Matrix3Xf skin_, skin_of_frame_, skin_at_end_;  // m
  bool told_to_the_end_ = false;  // skin_at_end_ is where the next frame is expected
  double off_ = 0, off_held_ = 0;
  ContactTickFigures figures_;
  DurationBins times_;

  std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  SolvedFrame waiting_;
  bool is_waiting_ = false, is_busy_ = false;  // a frame; the thread with one
  bool cuts_ = false;                          // the frame's ticks that are left
  bool ends_ = false;
  std::thread thread_;  // last: it begins when all else is there
};

/// For people: how many, how long each took, how far off they were.
[[nodiscard]] std::string text_of(const ContactTickFigures& figures);

}  // namespace palpable
