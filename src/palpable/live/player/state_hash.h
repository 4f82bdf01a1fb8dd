/// @file
/// The results of a run as one number: equal numbers mean bit-identical results.
#pragma once

#include "palpable/common/base/checksum.h"
#include "palpable/live/session/scene.h"
#include "palpable/live/sources/recording_file.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

/// Hash of one frame: its number and time, the camera's pose, all numbers of all touches, the
/// penetration and imbalance between bodies, and of each body its pose, deformed vertices, stress
/// and stated errors. Allocates nothing.
[[nodiscard]] std::uint64_t state_hash(const Scene& scene);

/// Hash of all states of a run, in their order.
class RunHash {
 public:
  void add(std::uint64_t state) {
    hash_.add(state);
    ++count_;
  }
  [[nodiscard]] int count() const { return count_; }
  /// 16 hexadecimal digits.
  [[nodiscard]] std::string text() const;

 private:
  WordHash hash_;
  int count_ = 0;
};

/// Compares the states of a replay with those of the live run.
class StateComparison {
 public:
  explicit StateComparison(std::vector<RecordedState> expected) : expected_(std::move(expected)) {}

  /// Adds the next state. States after the end of the live run count as equal.
  void add(int number, std::uint64_t hash);

  [[nodiscard]] int compared() const { return compared_; }
  [[nodiscard]] int different() const { return different_; }
  /// Number of the first frame whose state or number differs from the live run's.
  [[nodiscard]] std::optional<int> first_different() const { return first_different_; }
  /// Number of states of the live run.
  [[nodiscard]] int expected() const { return static_cast<int>(expected_.size()); }

 private:
  std::vector<RecordedState> expected_;
  int compared_ = 0;
  int different_ = 0;
  std::optional<int> first_different_;
};

}  // namespace palpable
