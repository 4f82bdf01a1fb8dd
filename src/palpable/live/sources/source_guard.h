/// @file
/// A filter between a source and the frame loop, so that no malfunction of a camera stops the loop.
#pragma once

#include "palpable/live/sources/frame_source.h"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpable {

/// Counts of a source's malfunctions. All of them are normal events; the loop continues.
struct SourceTroubles {
  int unreadable = 0;    ///< unusable frames: garbage, another size, no time
  int back_in_time = 0;  ///< of these, frames older than the previous one
  int dropped = 0;       ///< missing numbers between frames
  int stalls = 0;        ///< times that pictures stopped
  int losses = 0;        ///< times that the camera was unplugged or failed
};

/// Why a frame's images do not have the sizes of the source's format; empty if they have.
[[nodiscard]] std::string wrong_size(const Frame& frame, const FrameFormat& format);

/// Passes on only frames that the loop can use: images of the format's size, depths that are
/// positive or NaN, increasing times. All others become kUnreadable.
///
/// When a camera's clock restarts (the camera was plugged in again, or its driver restarted), all
/// later frames are older than the last good one. Therefore, after kClockRestart consecutive frames
/// that are older than the last good one but in order among themselves, an offset is added to their
/// times and to all later ones, so that time continues.
///
/// After a single frame from the far future all later frames would be too old. Therefore, frames
/// after a jump of more than kLongestGap are rejected until kClockRestart consecutive ones with
/// increasing times confirm the jump; their times are then kept. After a stall or a loss a jump is
/// normal and accepted at once.
class SourceGuard {
 public:
  static constexpr int kClockRestart = 5;
  static constexpr double kLongestGap = 5;  ///< s
  /// After this number of reports, malfunctions are only counted, so that a camera that fails
  /// in every second frame does not fill the disk in a day. Loss and return of a camera are
  /// always reported.
  static constexpr int kMostReports = 200;

  /// @param source  must outlive this
  explicit SourceGuard(FrameSource& source);

  /// As FrameSource::next(); Frame::time increases from frame to frame.
  FrameStatus next(Frame& frame);

  [[nodiscard]] const SourceTroubles& troubles() const { return troubles_; }
  /// Why the last unusable frame was unusable; empty if there was none.
  [[nodiscard]] const std::string& last_trouble() const { return last_trouble_; }
  /// Reports since the last call, one line each: the baseline of a stereo source, by which all its
  /// depths are scaled (in the first call), the source's notes, the first bad frame of a
  /// series, a stall, loss and return of a camera.
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
  bool may_jump_ = false;             // pictures have come back, and none was passed on yet
  bool is_lost_ = false;              // the camera was lost, and no picture has come since
  double last_time_ = 0;              // s, of the last frame passed on
  double period_ = 1.0 / 30;          // s, between the last two frames
  double longest_gap_ = kLongestGap;  // s; larger if the source's frames are that far apart
  double offset_ = 0;                 // s, added to the source's times after a restart of its clock
  enum class Odd { kNone, kBehind, kAhead } odd_ = Odd::kNone;
  int odd_row_ = 0;      // number of consecutive frames that were odd in the same way
  double odd_time_ = 0;  // time of the last odd frame
};

}  // namespace palpable
