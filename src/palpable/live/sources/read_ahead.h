/// @file
/// Recorded frames, read one ahead on a thread of their own: decoding a 720p pair takes about
/// 10 ms, for which the frame loop would otherwise wait.
#pragma once

#include "palpable/live/sources/frame_source.h"

#include <memory>
#include <string>
#include <vector>

namespace palpable {

/// Reads the frames of one recording; used by one thread.
class FrameReader {
 public:
  virtual ~FrameReader() = default;
  [[nodiscard]] virtual const FrameFormat& format() const = 0;
  /// Frames in all; -1 when it is not known.
  [[nodiscard]] virtual int count() const = 0;
  /// What FrameSource::take_notes() hands out.
  [[nodiscard]] virtual std::vector<std::string> notes() const { return {}; }
  /// Reads frame `number`; called with 0, 1, 2, ... until it returns kEnd. With kUnreadable and
  /// kWaiting, `trouble` says why.
  virtual FrameStatus read(int number, Frame& frame, std::string& trouble) = 0;
  /// What FrameSource::state() says after the last read(): of files always kRunning, of a recorded
  /// camera what it was.
  [[nodiscard]] virtual SourceState state() const { return SourceState::kRunning; }
};

/// A source that decodes the next frame while the last one is used.
[[nodiscard]] std::unique_ptr<FrameSource> read_ahead(std::unique_ptr<FrameReader> reader);

}  // namespace palpable
