/// @file
/// Wall times of the stages of a frame, as plain data that a frame can carry along.
///
/// Only these classes read a clock in the frame loop; no result depends on the times.
#pragma once

#include "palpable/common/base/contract.h"

#include <array>
#include <chrono>
#include <cstddef>
#include <span>
#include <string_view>

namespace palpable {

/// One stage's wall time.
struct StageTime {
  std::string_view name;  ///< a string literal: nothing is copied
  double ms = 0;
};

/// Milliseconds per named stage, in the order in which the stages first ran. Fixed capacity, so
/// filling it allocates nothing.
class StageTimes {
 public:
  static constexpr std::size_t kCapacity = 16;

  /// Adds `ms` to the stage `name`, which begins at 0.
  /// @param name  must outlive this object: a string literal
  /// @throws ContractViolation when there would be more than kCapacity stages
  void add(std::string_view name, double ms) {
    for (std::size_t i = 0; i < count_; ++i) {
      if (stages_[i].name == name) {
        stages_[i].ms += ms;
        return;
      }
    }
    PALPABLE_EXPECT(count_ < kCapacity, "a frame has at most 16 stages");
    stages_[count_++] = {name, ms};
  }

  /// Adds every stage of `others`.
  void add(const StageTimes& others) {
    for (const StageTime& stage : others.stages()) add(stage.name, stage.ms);
  }

  void clear() { count_ = 0; }

  [[nodiscard]] std::span<const StageTime> stages() const { return {stages_.data(), count_}; }

  /// Time of one stage, 0 if it did not run.
  [[nodiscard]] double ms(std::string_view name) const {
    for (const StageTime& stage : stages()) {
      if (stage.name == name) return stage.ms;
    }
    return 0;
  }

  /// All stages together.
  [[nodiscard]] double total_ms() const {
    double sum = 0;
    for (const StageTime& stage : stages()) sum += stage.ms;
    return sum;
  }

 private:
  std::array<StageTime, kCapacity> stages_{};
  std::size_t count_ = 0;
};

/// Adds the time from its construction to its destruction to `times`:
///
///     { const StageTimer timer(times, "contact");  ... }
class StageTimer {
 public:
  StageTimer(StageTimes& times, std::string_view name) : times_(times), name_(name) {}
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;
  ~StageTimer() {
    const std::chrono::duration<double, std::milli> taken = Clock::now() - start_;
    times_.add(name_, taken.count());
  }

 private:
  using Clock = std::chrono::steady_clock;
  StageTimes& times_;
  std::string_view name_;
  Clock::time_point start_ = Clock::now();
};

}  // namespace palpable
