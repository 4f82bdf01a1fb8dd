/// @file
/// How fast a run goes: measured always, over the whole run and since the last line about it.
///
/// Takes no memory after its construction, however long the run: durations are counted in bins.
/// Reads no clock; who plays says what the clocks show.
#pragma once

#include "palpable/common/base/stage_clock.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpable {

/// Durations, counted in bins of which each is 2 % wider than the one before, from 1 us to 5 min:
/// what lies below or above counts as that.
class DurationBins {
 public:
  void add(double ms);
  void clear();
  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// As percentile() of order_statistics.h, but off by up to 1 %; 0 where nothing was added.
  [[nodiscard]] double percentile(double share) const;

 private:
  static constexpr std::size_t kBins = 1000;
  std::array<std::uint32_t, kBins> bins_{};
  std::uint64_t count_ = 0;
};

/// What the clocks and counters show at one moment.
struct RunMoment {
  double now = 0;    ///< s, of a clock on the wall
  double cpu = 0;    ///< s of all threads of this process (process_cpu())
  int dropped = 0;   ///< frames that the source had and the loop did not get, so far
  int left_out = 0;  ///< frames that the files have in their texts only, so far
};

/// Figures of a stretch of a run.
struct RunFigures {
  struct Stage {
    std::string_view name;
    double p50_ms = 0;
    double p99_ms = 0;
  };
  std::uint64_t frames = 0;
  double frames_per_second = 0;
  double age_p50_ms = 0;  ///< from when a frame was taken to when its picture was shown
  double age_p99_ms = 0;
  int dropped = 0;
  int left_out = 0;
  double cpu_ms_per_frame = 0;
  std::vector<Stage> stages;  ///< in the order in which they first ran
};

class RunStats {
 public:
  explicit RunStats(const RunMoment& begin) : all_(begin), recent_(begin) {}

  /// One frame that was shown, or answered where nobody looks.
  /// @param age_ms  from when it was taken; NaN: not known
  void add(const StageTimes& times, double age_ms);

  /// Of the whole run.
  [[nodiscard]] RunFigures all(const RunMoment& now) const { return all_.figures(now); }
  /// Whether the last stretch has taken a second.
  [[nodiscard]] bool is_second_over(double now) const { return now - recent_.begin.now >= 1; }
  /// Of the stretch since the last call; begins the next one.
  [[nodiscard]] RunFigures end_stretch(const RunMoment& now);

 private:
  struct Stretch {
    explicit Stretch(const RunMoment& start) : begin(start) {}
    void add(const StageTimes& times, double age_ms);
    [[nodiscard]] RunFigures figures(const RunMoment& now) const;
    void restart(const RunMoment& start);

    RunMoment begin;
    std::uint64_t frames = 0;
    DurationBins age;
    std::array<std::string_view, StageTimes::kCapacity> names{};
    std::array<DurationBins, StageTimes::kCapacity> stages{};
    std::size_t stage_count = 0;
  };
  Stretch all_;
  Stretch recent_;
};

/// One line for people: "31.0 frames/s   age 48 ms (p99 61)   0 dropped, 12 in texts only   ...".
[[nodiscard]] std::string text_of(const RunFigures& figures);

}  // namespace palpable
