/// @file
/// When a camera's pictures were taken, from time stamps of which some are wrong.
#pragma once

#include <string>

namespace palpable {

/// The driver's time stamp of a picture, and what is known of it.
struct PictureStamp {
  double stamp = 0;              ///< s, by the driver's clock; 0 or less: the driver has none
  double arrival = 0;            ///< s, by the system's clock (wall_clock.h): now
  bool is_system_clock = false;  ///< the driver says that its clock is the system's
};

/// Converts time stamps to the system's clock.
///
/// A picture is taken after the start of its stream and before it arrives. Some drivers give the
/// first pictures stamps of an earlier stream, or of no time at all (raspberrypi/linux#1984: 4e9
/// s); others never advance them (raspberrypi/linux#2351). Tracking would then see steps of time of
/// minutes, or negative ones, and two cameras would never have pictures of the same moment.
///
/// * A stamp that is outside of these limits is refused with its picture, which may be old, too.
/// * Of kSameClock such pictures in a row the last one is accepted. If their stamps advance as the
///   system's clock does, the driver has another clock, and its offset is kept; otherwise the time
///   of arrival is the picture's.
/// * A stamp that is not newer than the one before is replaced by the time of arrival.
class PictureClock {
 public:
  static constexpr int kSameClock = 3;
  /// s; the stamps that drivers compute from a camera's clock are off by some 10 ms.
  static constexpr double kSlack = 0.1;

  /// A stream was started.
  /// @param now  s, by the system's clock
  void start(double now);

  /// Judges the stamp of the next picture. If trouble() is empty, time() is the picture's.
  void add(const PictureStamp& picture);

  /// s, by the system's clock.
  [[nodiscard]] double time() const { return time_; }
  /// Why the last picture must be left out; empty: it need not be.
  [[nodiscard]] const std::string& trouble() const { return trouble_; }

 private:
  void add_odd(const PictureStamp& picture, double seconds_before_start);

  double start_ = 0;  // s, when the stream was started, by the system's clock
  bool knows_offset_ = false;
  double offset_ = 0;      // s, added to a stamp it is a time of the system's clock
  double last_stamp_ = 0;  // of the last picture that was accepted; 0: none
  int odd_row_ = 0;        // pictures in a row whose stamps were outside of the limits
  int odd_together_ = 0;   // those of them that advance together with the system's clock
  double odd_stamp_ = 0;   // of the last of them
  double odd_offset_ = 0;  // s, arrival less stamp of the last of them
  double time_ = 0;
  std::string trouble_;
};

}  // namespace palpable
