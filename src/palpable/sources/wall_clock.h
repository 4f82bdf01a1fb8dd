/// @file
/// The time of day as an argument, so that what waits can be tested without waiting.
#pragma once

namespace palpable {

class WallClock {
 public:
  virtual ~WallClock() = default;
  /// s since some moment; never goes back.
  [[nodiscard]] virtual double now() = 0;
  /// Returns after so many seconds.
  virtual void sleep(double seconds) = 0;
};

/// The machine's.
[[nodiscard]] WallClock& system_clock();

}  // namespace palpable
