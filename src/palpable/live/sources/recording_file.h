/// @file
/// A recording in one file: what a source gave, and what a live run made of it.
/// docs/recording_file.md has the layout byte by byte.
///
///     magic, version | about | frame frame state frame state silence frame ... | end
///
/// It grows chunk by chunk, each with its length and a checksum (word_hash.h): a file that was cut
/// off anywhere can be read up to its last whole chunk.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/base/growing_file.h"
#include "palpable/common/base/json.h"
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

/// The ending of a recording's name, by which open_source() knows it: ".palprec".
inline constexpr const char* kRecordingEnding = ".palprec";
[[nodiscard]] bool is_recording_name(const std::filesystem::path& path);

/// What a run answered to one frame.
struct RecordedState {
  int number = 0;          ///< the frame's
  std::uint64_t hash = 0;  ///< of the whole state (player/state_hash.h)
  std::string line = {};   ///< the same for people and programs, as docs/touch_events.md has it
};

/// What a second process that answers loads exactly had to do with one frame (session/refiner.h).
struct RecordedRefinement {
  bool asked = false;      ///< for the load of this frame's state
  Eigen::Matrix3Xf exact;  ///< (3 x W) m, taken up with this frame; no columns: nothing was
};

/// Writes a recording. Each chunk is with the system when its function returns: it outlives the
/// program. Functions throw Error "FILE: cannot be written: REASON"; the file then ends with the
/// chunk before, and nothing more may be added.
class RecordingWriter {
 public:
  /// Begins the file anew.
  /// @param run  what a replay is to know beside the frames' format: an object
  RecordingWriter(const std::filesystem::path& path, const FrameFormat& format, const Json& run);

  /// A frame as it came from its source. @pre its images have the format's size (wrong_size())
  /// @param taken  FrameSource::taken()
  void add_frame(const Frame& frame, std::optional<double> taken);
  void add_unreadable(int number, std::string_view why);
  /// No pictures come. @param state  kStalled or kGone
  void add_silence(SourceState state, std::string_view why);
  /// Of the frame whose state is added next.
  void add_refinement(const RecordedRefinement& refinement);
  void add_state(const RecordedState& state);
  /// The run has ended as its user wished.
  void finish();

  [[nodiscard]] std::uint64_t size() const { return size_; }  ///< bytes

 private:
  void begin(std::uint32_t kind);
  void append();

  GrowingFile file_;
  std::uint64_t size_ = 0;
  std::string chunk_;  // the one that is being put together
  ImagePacker packer_;
};

/// What is in a recording, without its images.
struct RecordingContents {
  FrameFormat format;
  Json run;  ///< an object
  int frames = 0;
  std::vector<RecordedState> states;  ///< in their order
  bool finished = false;              ///< its run has ended as its user wished
  /// Why nothing behind a place in the file can be read; empty where all can: it was cut off, or
  /// damaged.
  std::string ending;
  bool damaged = false;  ///< and not just cut off
};

/// Looks through a recording, and reads all but its images. Whatever the bytes are, the result is a
/// recording up to its first odd chunk, or a problem that names the file.
[[nodiscard]] Result<RecordingContents> read_recording(const std::filesystem::path& path);

/// Reads what was refined, state by state.
class RecordedRefinements {
 public:
  /// A problem, as read_recording().
  [[nodiscard]] static Result<RecordedRefinements> open(const std::filesystem::path& path);
  RecordedRefinements(RecordedRefinements&&) noexcept;
  RecordedRefinements& operator=(RecordedRefinements&&) noexcept;
  ~RecordedRefinements();

  /// What belongs to the n-th state, from 0 on; nothing where nothing does, or where the file is
  /// damaged.
  void read(int n, RecordedRefinement& refinement);

 private:
  struct Parts;
  explicit RecordedRefinements(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

/// Plays a recording. It gives what the recorded source gave, also what could not be read, and the
/// silence of a camera, without waiting. A frame whose checksum is wrong is unreadable and the last
/// one; FrameSource::take_notes() says where the file was cut off.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> open_recording(
    const std::filesystem::path& path);

}  // namespace palpable
