/// @file
/// How many pictures a second a camera really takes.
#pragma once

#include <array>
#include <optional>

namespace palpable {

/// Measures the rate from the times and numbers of pictures, of which some may be missing: from
/// the median of the intervals, which neither a pause nor a picture that was read late changes.
///
/// Pictures of the first kSettle seconds do not count: the automatic exposure is still changing.
class PictureRate {
 public:
  static constexpr int kIntervals = 15;
  static constexpr double kSettle = 0.5;  ///< s

  /// Forgets all pictures.
  void restart() { *this = {}; }

  /// @param time    s
  /// @param number  the device's number of the picture, counting those that were not read
  void add(double time, int number);

  /// 1/s; empty until kIntervals intervals were seen, of which it is the median.
  [[nodiscard]] std::optional<double> rate() const;

 private:
  struct Picture {
    double time;
    int number;
  };
  std::optional<double> first_time_;
  std::optional<Picture> last_;
  std::array<double, kIntervals> intervals_{};  // s
  int count_ = 0;                               // of valid intervals
};

/// Whether a measured rate is much smaller than the one that was set: exposures of twice the period
/// halve it. 25 pictures instead of 30 are usual where lamps flicker at 50 Hz, and nothing to
/// complain of.
[[nodiscard]] bool is_far_below(double measured, double wanted);

}  // namespace palpable
