/// @file
/// Where frames come from: a camera, or a recording of one.
#pragma once

#include "palpable/common/geometry/frame.h"

#include <optional>
#include <string>
#include <vector>

namespace palpable {

enum class FrameStatus {
  kFrame,       ///< the frame was filled
  kUnreadable,  ///< this one could not be used: its number is set, its images are unspecified
  kWaiting,     ///< nothing came within kLongestWait; state() says whether something is wrong
  kEnd          ///< nothing was read and nothing will be
};

/// The state of a source. A recording is always kRunning.
enum class SourceState {
  kRunning,
  kStalled,  ///< the camera is there, but no pictures come
  kGone      ///< the camera is not there; it is looked for, and frames go on when it is back
};

/// A sequence of frames, read once from front to back by one thread.
///
/// A recording waits for its reader: no frame is left out. A live source gives the newest frame
/// that it has; the numbers of frames that were not read in time are missing.
class FrameSource {
 public:
  /// s; next() of a live source returns kWaiting after this time, so that its caller can end.
  static constexpr double kLongestWait = 0.1;

  virtual ~FrameSource() = default;

  /// Constant over the life of the source.
  [[nodiscard]] virtual const FrameFormat& format() const = 0;

  /// Fills `frame`, whose memory is used again where it suffices. Goes on after kUnreadable; after
  /// kEnd every further call returns kEnd. Does not throw, whatever files or cameras do.
  virtual FrameStatus next(Frame& frame) = 0;

  /// Frames in all, the unreadable ones included; -1 when it is not known.
  [[nodiscard]] virtual int frame_count() const = 0;

  /// Notes since the last call that concern no single frame: images left out because they have no
  /// partner, an exposure that could not be locked. One line each.
  [[nodiscard]] virtual std::vector<std::string> take_notes() { return {}; }

  /// Why the last unreadable frame could not be read, naming its file, or why a camera gives no
  /// pictures; empty when nothing was wrong.
  [[nodiscard]] virtual std::string last_trouble() const = 0;

  /// Whether frames come at their own pace and not at the reader's.
  [[nodiscard]] virtual bool is_live() const { return false; }

  /// When the last frame that next() gave was taken: s, of the clock of system_clock()
  /// (wall_clock.h) unless a camera's driver has another one. A paced recording says when the frame
  /// was due. Nothing where it means nothing: a recording that waits for its reader.
  [[nodiscard]] virtual std::optional<double> taken() const { return std::nullopt; }

  [[nodiscard]] virtual SourceState state() const { return SourceState::kRunning; }
};

}  // namespace palpable
