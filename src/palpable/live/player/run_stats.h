/// @file
/// Speed of a run, measured over the whole run and since the last report.
///
/// Allocates nothing after construction, however long the run is, because durations are counted in
/// bins. Reads no clock: the caller passes the times.
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

/// A histogram of durations from 1 us to 5 min. Each bin is 2 % wider than the previous one;
/// durations outside the range count in the first or last bin.
class DurationBins {
 public:
  void add(double ms);
  void clear();
  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// As percentile() of order_statistics.h with an error up to 1 %; 0 without durations.
  [[nodiscard]] double percentile(double share) const;

 private:
  static constexpr std::size_t kBins = 1000;
  std::array<std::uint32_t, kBins> bins_{};
  std::uint64_t count_ = 0;
};

/// Clocks and counters at one moment.
struct RunMoment {
  double now = 0;    ///< s, wall clock
  double cpu = 0;    ///< s, CPU time of all threads of this process (process_cpu_seconds())
  int dropped = 0;   ///< frames that the source dropped before the loop, so far
  int left_out = 0;  ///< frames that are in the text files only, so far
};

/// Figures of a part of a run.
struct RunFigures {
  struct Stage {
    std::string_view name;
    double p50_ms = 0;
    double p99_ms = 0;
  };
  std::uint64_t frames = 0;
  double frames_per_second = 0;
  double age_p50_ms = 0;  ///< time from taking a frame to showing its picture
  double age_p99_ms = 0;
  int dropped = 0;
  int left_out = 0;
  double cpu_ms_per_frame = 0;
  std::vector<Stage> stages;  ///< in the order of their first run
};

class RunStats {
 public:
  explicit RunStats(const RunMoment& begin) : all_(begin), recent_(begin) {}

  /// Adds one frame that was shown, or processed if there is no window.
  /// @param age_ms  time since it was taken; NaN: unknown
  void add(const StageTimes& times, double age_ms);

  /// The figures of the whole run.
  [[nodiscard]] RunFigures all(const RunMoment& now) const { return all_.figures(now); }
  /// Whether the current part has lasted a second.
  [[nodiscard]] bool is_second_over(double now) const { return now - recent_.begin.now >= 1; }
  /// The figures since the last call. Begins a new part.
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

/// One readable line: "31.0 frames/s age 48 ms (p99 61) 0 dropped, 12 in texts only ...".
[[nodiscard]] std::string text_of(const RunFigures& figures);

}  // namespace palpable
