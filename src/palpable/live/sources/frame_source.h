/// @file
/// The interface of sources of frames: cameras and recordings.
#pragma once

#include "palpable/common/geometry/frame.h"

#include <optional>
#include <string>
#include <vector>

namespace palpable {

enum class FrameStatus {
  kFrame,       ///< the frame was filled
  kUnreadable,  ///< this frame is unusable: its number is set, its images are unspecified
  kWaiting,     ///< no frame came within kLongestWait; state() tells whether there is a problem
  kEnd          ///< there are no further frames
};

/// The state of a source. A recording is always kRunning.
enum class SourceState {
  kRunning,
  kStalled,  ///< the camera is connected but sends no pictures
  kGone      ///< the camera is disconnected; it is searched, and frames continue when it is back
};

/// A sequence of frames, read once from front to back by one thread.
///
/// A recording waits for its reader, so that no frame is skipped. A live source returns its newest
/// frame; the numbers of skipped frames are missing.
class FrameSource {
 public:
  /// s; next() of a live source returns kWaiting after this time, so that its caller can stop.
  static constexpr double kLongestWait = 0.1;

  virtual ~FrameSource() = default;

  /// Constant during the life of the source.
  [[nodiscard]] virtual const FrameFormat& format() const = 0;

  /// Fills `frame` and reuses its memory. After kUnreadable it can be called again; after kEnd it
  /// always returns kEnd. Does not throw, whatever the files or cameras do.
  virtual FrameStatus next(Frame& frame) = 0;

  /// Number of all frames, unreadable ones included; -1 if unknown.
  [[nodiscard]] virtual int frame_count() const = 0;

  /// Notes since the last call that do not concern a single frame, e.g. images that were skipped
  /// because they have no partner, or an exposure that could not be locked. One line each.
  [[nodiscard]] virtual std::vector<std::string> take_notes() { return {}; }

  /// Why the last unreadable frame could not be read, naming its file, or why a camera sends no
  /// pictures; empty if there was no problem.
  [[nodiscard]] virtual std::string last_trouble() const = 0;

  /// Whether frames come at their own pace, whether or not the reader is ready.
  [[nodiscard]] virtual bool is_live() const { return false; }

  /// Time, s, at which the last frame of next() was taken, by the clock of system_clock()
  /// (wall_clock.h) or that of a camera's driver. For a paced recording, the time at which the
  /// frame was due. Empty for a recording that waits for its reader.
  [[nodiscard]] virtual std::optional<double> taken() const { return std::nullopt; }

  [[nodiscard]] virtual SourceState state() const { return SourceState::kRunning; }
};

}  // namespace palpable
