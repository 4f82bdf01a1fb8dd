/// @file
/// A recording in one file: the items of a source and the results of a live run.
/// docs/recording_file.md has the layout byte by byte.
///
///     magic, version | about | frame frame state frame state silence frame ... | end
///
/// It grows by chunks, each with its length and a checksum (checksum.h): a file that is truncated
/// anywhere can be read up to its last complete chunk.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/geometry/frame.h"
#include "palpable/live/sources/frame_source.h"
#include "palpable/live/sources/packed_image.h"

#include <Eigen/Core>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// The extension of recordings, by which open_source() recognises them: ".palprec".
inline constexpr const char* kRecordingEnding = ".palprec";
[[nodiscard]] bool is_recording_name(const std::filesystem::path& path);

/// The result of a run for one frame.
struct RecordedState {
  int number = 0;          ///< the frame's
  std::uint64_t hash = 0;  ///< of the whole state (player/state_hash.h)
  std::string line = {};   ///< a readable summary in the format of docs/touch_events.md
};

/// The part of the refiner's process in one frame (session/refiner.h).
struct RecordedRefinement {
  bool asked = false;      ///< a full-order solution was requested for this frame's state
  Eigen::Matrix3Xf exact;  ///< (3 x W) m, solution adopted in this frame; no columns: none
};

/// Writes a recording. When a function returns, its chunk has been passed to the system and
/// survives the end of the program. Functions throw Error "FILE: cannot be written: REASON"; the
/// file then ends with the previous chunk, and nothing more may be added.
class RecordingWriter {
 public:
  /// The file is written with the first frame, or by finish(): until then a file that is there
  /// stays as it is, unless it was opened as kEmptied.
  /// @param run  an object with data that a replay needs beside the frames' format
  /// @param opening  what becomes of a file that is there; two writers of one file at once exclude
  ///                 each other unless it is kEmptied
  RecordingWriter(const std::filesystem::path& path, const FrameFormat& format, const Json& run,
                  Opening opening = Opening::kAlone);

  /// Adds a frame as returned by its source. @pre its images have the format's size (wrong_size())
  /// @param taken  FrameSource::taken()
  void add_frame(const Frame& frame, std::optional<double> taken);
  void add_unreadable(int number, std::string_view why);
  /// Adds a period without pictures. @param state kStalled or kGone
  void add_silence(SourceState state, std::string_view why);
  /// Belongs to the frame whose state is added next.
  void add_refinement(const RecordedRefinement& refinement);
  void add_state(const RecordedState& state);
  /// Marks the recording as complete: the run was ended normally.
  void finish();

  [[nodiscard]] std::uint64_t size() const { return size_; }  ///< bytes

 private:
  void begin(std::uint32_t kind);
  void append();
  void write_pending();

  GrowingFile file_;
  std::uint64_t size_ = 0;
  std::string chunk_;    // the chunk that is being composed
  std::string pending_;  // what comes before the first frame
  bool begun_ = false;   // the first frame or the end was written
  ImagePacker packer_;
};

/// The content of a recording without its images.
struct RecordingContents {
  FrameFormat format;
  Json run;  ///< an object
  int frames = 0;
  std::vector<RecordedState> states;  ///< in their order
  bool finished = false;              ///< its run was ended normally
  /// Why the file cannot be read beyond some position; empty if all of it is readable. The reason
  /// is truncation or damage.
  std::string ending;
  bool damaged = false;  ///< the reason is damage, not truncation
};

/// Scans a recording and reads everything but its images. For any bytes the result is a recording
/// up to the first invalid chunk, or a problem that names the file.
[[nodiscard]] Result<RecordingContents> read_recording(const std::filesystem::path& path);

/// Reads the refinements of a recording, state by state.
class RecordedRefinements {
 public:
  /// A problem, as in read_recording().
  [[nodiscard]] static Result<RecordedRefinements> open(const std::filesystem::path& path);
  RecordedRefinements(RecordedRefinements&&) noexcept;
  RecordedRefinements& operator=(RecordedRefinements&&) noexcept;
  ~RecordedRefinements();

  /// The refinement that belongs to the n-th state, n >= 0; empty if there is none or the
  /// file is damaged.
  void read(int n, RecordedRefinement& refinement);

 private:
  struct Parts;
  explicit RecordedRefinements(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

/// Plays a recording. It returns what the recorded source returned, including unreadable frames and
/// states of a camera, without waiting. A frame with a wrong checksum is unreadable and the last
/// one; FrameSource::take_notes() reports where the file was truncated.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> open_recording(
    const std::filesystem::path& path);

}  // namespace palpable
