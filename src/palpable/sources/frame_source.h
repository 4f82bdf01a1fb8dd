/// @file
/// Where frames come from: a camera, or a recording of one.
#pragma once

#include "palpable/geometry/frame.h"

#include <string>
#include <vector>

namespace palpable {

enum class FrameStatus {
  kFrame,       ///< the frame was filled
  kUnreadable,  ///< this one could not be used: its number is set, its images are unspecified
  kWaiting,     ///< nothing came within kLongestWait; state() says whether that is trouble
  kEnd          ///< nothing was read and nothing will be
};

/// How a source does at present. A recording is always kRunning.
enum class SourceState {
  kRunning,
  kStalled,  ///< the camera is there, but no pictures come
  kGone      ///< the camera is not there; it is looked for, and frames go on when it is back
};

/// A sequence of frames, read once from front to back by one thread.
///
/// A recording waits for whoever reads it: no frame is passed over. A live source gives the newest
/// frame that it has, and the numbers of those that nobody took in time are missing.
class FrameSource {
 public:
  /// s; next() of a live source answers kWaiting after it, so that whoever calls can end.
  static constexpr double kLongestWait = 0.1;

  virtual ~FrameSource() = default;

  /// Constant over the life of the source.
  [[nodiscard]] virtual const FrameFormat& format() const = 0;

  /// Fills `frame`, whose memory is used again where it suffices. Goes on after kUnreadable; after
  /// kEnd every further call answers kEnd. Never throws for what the world does.
  virtual FrameStatus next(Frame& frame) = 0;

  /// Frames in all, the unreadable ones included; -1 when the source cannot know.
  [[nodiscard]] virtual int frame_count() const = 0;

  /// What is to be told once and concerns no single frame: images left out because they have no
  /// partner, an exposure that could not be locked. One line each; empties the list.
  [[nodiscard]] virtual std::vector<std::string> take_notes() { return {}; }

  /// Why the last unreadable frame was, naming its file, or what keeps a camera from giving
  /// pictures; empty when there was nothing.
  [[nodiscard]] virtual std::string last_trouble() const = 0;

  /// Whether frames come at their own pace and not at the reader's.
  [[nodiscard]] virtual bool is_live() const { return false; }

  [[nodiscard]] virtual SourceState state() const { return SourceState::kRunning; }
};

}  // namespace palpable
