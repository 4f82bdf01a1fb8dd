/// @file
/// A clock as an interface, so that code that waits can be tested without waiting.
#pragma once

namespace palpable {

class WallClock {
 public:
  virtual ~WallClock() = default;
  /// s since a fixed moment; never decreases.
  [[nodiscard]] virtual double now() = 0;
  /// Returns after this many seconds.
  virtual void sleep(double seconds) = 0;
};

/// The machine's clock.
[[nodiscard]] WallClock& system_clock();

}  // namespace palpable
