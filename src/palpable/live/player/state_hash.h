/// @file
/// All that a run has answered to a frame, as one number: equal numbers say that nothing differs,
/// not in the last bit.
#pragma once

#include "palpable/common/base/word_hash.h"
#include "palpable/live/session/scene.h"
#include "palpable/live/sources/recording_file.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

/// Of one frame: its number and time, where the camera is, every number of every touch, what bodies
/// do to each other, and of each body where it is drawn, its displaced vertices, their stress and
/// the stated errors. Allocates nothing.
[[nodiscard]] std::uint64_t state_hash(const Scene& scene);

/// Of all states of a run, in their order.
class RunHash {
 public:
  void add(std::uint64_t state) {
    hash_.add(state);
    ++count_;
  }
  [[nodiscard]] int count() const { return count_; }
  /// 16 digits.
  [[nodiscard]] std::string text() const;

 private:
  WordHash hash_;
  int count_ = 0;
};

/// A replay's states beside those that the live run had.
class StateComparison {
 public:
  explicit StateComparison(std::vector<RecordedState> expected) : expected_(std::move(expected)) {}

  /// The next state. Those behind the last one that is known count as equal.
  void add(int number, std::uint64_t hash);

  [[nodiscard]] int compared() const { return compared_; }
  [[nodiscard]] int different() const { return different_; }
  /// Number of the first frame whose state differs, or that is another frame than the live run
  /// answered.
  [[nodiscard]] std::optional<int> first_different() const { return first_different_; }
  /// How many states are known.
  [[nodiscard]] int expected() const { return static_cast<int>(expected_.size()); }

 private:
  std::vector<RecordedState> expected_;
  int compared_ = 0;
  int different_ = 0;
  std::optional<int> first_different_;
};

}  // namespace palpable
