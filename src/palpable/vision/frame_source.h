/// @file
/// Where frames come from.
#pragma once

#include "palpable/vision/frame.h"

#include <string>

namespace palpable {

enum class FrameStatus {
  kFrame,       ///< the frame was filled
  kUnreadable,  ///< this one could not be read: its number is set, its images are unspecified
  kEnd          ///< nothing was read and nothing will be
};

/// A sequence of frames, read once from front to back by one thread.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  /// Constant over the life of the source.
  [[nodiscard]] virtual const FrameFormat& format() const = 0;

  /// Fills `frame`, whose memory is used again where it suffices. Goes on after kUnreadable, which
  /// is counted; after kEnd every further call answers kEnd. Never throws for what the world does.
  virtual FrameStatus next(Frame& frame) = 0;

  /// Frames in all, the unreadable ones included; -1 when the source cannot know.
  [[nodiscard]] virtual int frame_count() const = 0;

  /// How many answers were kUnreadable so far.
  [[nodiscard]] virtual int unreadable_count() const = 0;

  /// Why the last unreadable frame was, naming its file; empty when there was none.
  [[nodiscard]] virtual std::string last_trouble() const = 0;
};

}  // namespace palpable
