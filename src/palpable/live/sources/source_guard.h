/// @file
/// Stands between a source and the frame loop, so that no fault of a camera can stop the loop.
#pragma once

#include "palpable/live/sources/frame_source.h"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpable {

/// Faults of a source, counted. All of them are expected to happen; the loop goes on.
struct SourceTroubles {
  int unreadable = 0;    ///< frames that could not be used: garbage, another size, no time
  int back_in_time = 0;  ///< of these, frames older than the one before
  int dropped = 0;       ///< numbers missing between frames that came
  int stalls = 0;        ///< how often pictures stopped coming
  int losses = 0;        ///< how often the camera was unplugged or failed
};

/// Why a frame's images do not have the sizes that its source has said; empty where they have.
[[nodiscard]] std::string wrong_size(const Frame& frame, const FrameFormat& format);

/// Lets through only frames that the loop can use: images of the format's size, depths that are
/// positive or NaN, times that increase. All others become kUnreadable; the caller keeps its state.
///
/// When a camera's clock restarts (it was plugged in again, its driver restarted), every frame
/// would be older than the last good one for ever. So after kClockRestart frames in a row that are
/// older than the last good one, but in order among themselves, an offset is added to their times
/// and to all later ones, so that time continues.
///
/// One frame from the far future would make all later frames old. So after a jump of more than
/// kLongestGap frames are held back until kClockRestart of them in a row, each later than the one
/// before, confirm the jump; their times are then kept. After a stall or a loss a jump is normal
/// and let through at once.
class SourceGuard {
 public:
  static constexpr int kClockRestart = 5;
  static constexpr double kLongestGap = 5;  ///< s
  /// After so many reports faults are only counted, so that a camera that fails in every second
  /// frame all day does not fill the disk. That a camera is gone or back is always reported.
  static constexpr int kMostReports = 200;

  /// @param source  must outlive this
  explicit SourceGuard(FrameSource& source);

  /// As FrameSource::next. Frame::time grows from frame to frame.
  FrameStatus next(Frame& frame);

  [[nodiscard]] const SourceTroubles& troubles() const { return troubles_; }
  /// Why the last frame was not usable; empty when there was none.
  [[nodiscard]] const std::string& last_trouble() const { return last_trouble_; }
  /// Reports since the last call, one line each: the source's notes, the first bad frame of a
  /// series, a stall, a camera that is gone or back.
  [[nodiscard]] std::vector<std::string> take_reports();

 private:
  [[nodiscard]] std::string what_is_wrong_with(Frame& frame);
  [[nodiscard]] std::string time_trouble(Frame& frame);
  void watch_state();
  void report(std::string line);
  void report_always(std::string_view line) { reports_.emplace_back(line); }

  FrameSource& source_;
  SourceState state_ = SourceState::kRunning;
  SourceTroubles troubles_;
  std::string last_trouble_;
  std::vector<std::string> reports_;
  int reported_ = 0;
  bool in_bad_row_ = false;  // the last frame was unusable
  int last_number_ = -1;
  bool has_time_ = false;
  bool may_jump_ = false;             // pictures come again, and none was let through yet
  bool is_lost_ = false;              // the camera is gone, and no picture has come since
  double last_time_ = 0;              // s, of the last frame let through
  double period_ = 1.0 / 30;          // s, between the last two
  double longest_gap_ = kLongestGap;  // s; more where a source's frames are that far apart
  double offset_ = 0;                 // s, added to the source's times since its clock began anew
  enum class Odd { kNone, kBehind, kAhead } odd_ = Odd::kNone;
  int odd_row_ = 0;      // frames in a row that were odd in the same way
  double odd_time_ = 0;  // the last such frame's
};

}  // namespace palpable
