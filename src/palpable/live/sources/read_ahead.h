/// @file
/// Reads recorded frames one ahead on a thread of its own: decoding a 720p pair takes about 10 ms,
/// for which the frame loop would otherwise wait.
#pragma once

#include "palpable/live/sources/frame_source.h"

#include <memory>
#include <string>
#include <vector>

namespace palpable {

/// Reads the frames of one recording. Used by one thread.
class FrameReader {
 public:
  virtual ~FrameReader() = default;
  [[nodiscard]] virtual const FrameFormat& format() const = 0;
  /// Number of all frames; -1 if unknown.
  [[nodiscard]] virtual int count() const = 0;
  /// The result of FrameSource::take_notes().
  [[nodiscard]] virtual std::vector<std::string> notes() const { return {}; }
  /// Reads frame `number`; called with 0, 1, 2, ... until it returns kEnd. `trouble` receives the
  /// reason for kUnreadable and kWaiting.
  virtual FrameStatus read(int number, Frame& frame, std::string& trouble) = 0;
  /// The result of FrameSource::state() after the last read(): always kRunning for files, the
  /// recorded state for a recorded camera.
  [[nodiscard]] virtual SourceState state() const { return SourceState::kRunning; }
};

/// A source that decodes the next frame while the previous one is used.
[[nodiscard]] std::unique_ptr<FrameSource> read_ahead(std::unique_ptr<FrameReader> reader);

}  // namespace palpable
