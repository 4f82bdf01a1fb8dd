/// @file
/// The clock as an argument, so that code that waits can be tested without waiting.
#pragma once

namespace palpable {

class WallClock {
 public:
  virtual ~WallClock() = default;
  /// s since some moment; never decreases.
  [[nodiscard]] virtual double now() = 0;
  /// Returns after this many seconds.
  virtual void sleep(double seconds) = 0;
};

/// The machine's.
[[nodiscard]] WallClock& system_clock();

}  // namespace palpable
