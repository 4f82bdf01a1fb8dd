/// @file
/// Records a run while it runs, on a thread of its own.
///
///     source ──> recorded() ──────────────────────────> loop ──> state ──┐
///                   └─ copy ─> queue ─> thread: pack, write <────────────┘
///
/// Where frames come at their own pace, a frame that the disk is too slow for is not passed to the
/// loop either; a source that waits for its reader waits for the disk. So the loop processes
/// exactly the recorded frames, and a replay processes the same ones.
#pragma once

#include "palpable/common/base/json.h"
#include "palpable/live/player/bounded_queue.h"
#include "palpable/live/player/state_hash.h"
#include "palpable/live/sources/frame_source.h"
#include "palpable/live/sources/recording_file.h"

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

namespace palpable {

struct RecorderCounts {
  int frames = 0;            ///< in the file
  int left_out = 0;          ///< dropped, also for the loop, because the disk was too slow
  std::uint64_t bytes = 0;   ///< of the file
  RunHash states;            ///< of the frames in the file
  bool ended_early = false;  ///< the disk refused data
};

/// What is wrong with a recording that was finished with these counts: it was removed, replaced or
/// cut off by somebody else, so that the file does not hold what was written to it. Empty: nothing.
/// Reads the heads of the file's chunks, not its pictures.
[[nodiscard]] std::string lost_of_recording(const std::filesystem::path& file,
                                            const RecorderCounts& counts);

/// If the disk refuses data (it is full), the recording ends with its last complete chunk, and the
/// run continues without it: take_trouble() reports that once.
class Recorder {
 public:
  /// Begins the file. @param run data of the run that a replay needs
  /// @param opening  what becomes of a file that is there
  /// @throws Error when it cannot be written, is there or is being written by another run
  Recorder(const std::filesystem::path& file, const FrameFormat& format, const Json& run,
           Opening opening = Opening::kAlone);
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;
  /// Ends the thread. Without finish() the file counts as truncated.
  ~Recorder();

  /// Number of frames that may wait for the disk: 0.2 s of a camera, 33 MB at 720p.
  static constexpr std::size_t kFrames = 6;

  /// Called on the source's thread. Returns whether there was room for a copy; with `waits` it
  /// waits for room. Always returns true once the recording has ended early.
  bool add_frame(const Frame& frame, std::optional<double> taken, bool waits);
  bool add_unreadable(int number, std::string_view why, bool waits);
  bool add_silence(SourceState state, std::string_view why, bool waits);
  /// Records what the refiner, the process that computes full-order solutions, contributed to the
  /// frame whose state is added next. Called on the loop's thread.
  /// @param asked  whether a solution was requested
  /// @param exact  the full-order solution that was adopted; null: none
  void add_refinement(bool asked, const Eigen::Matrix3Xf* exact);
  /// Called on the loop's thread: the result of a frame.
  /// @param line  as in docs/touch_events.md
  void add_state(int number, std::uint64_t hash, std::string_view line);

  /// Writes the waiting items and completes the file. Later frames are not recorded.
  RecorderCounts finish();
  /// The reason why the recording has ended early; returned once.
  [[nodiscard]] std::optional<std::string> take_trouble();

 private:
  // Items of the source and items of the loop have separate pools, so that a fast source cannot use
  // up the items that the loop's thread needs.
  struct Item {
    enum class Kind { kFrame, kUnreadable, kSilence, kRefinement, kState } kind = Kind::kFrame;
    Frame frame;  // kUnreadable: only its number
    std::optional<double> taken;
    SourceState silence = SourceState::kStalled;
    std::string why;
    RecordedState state;
    RecordedRefinement refinement;
  };
  using Items = BoundedQueue<std::unique_ptr<Item>>;

  [[nodiscard]] bool is_over() const { return ended_early_ || finished_; }
  template <class Fill>
  bool add_of_source(bool waits, const Fill& fill);
  template <class Fill>
  void add_of_loop(const Fill& fill);
  void run_thread();
  void finish_thread();
  void write(const Item& item);
  void end_early(const std::string& why);

  static constexpr std::size_t kStates = 64;
  std::filesystem::path path_;
  RecordingWriter writer_;  // used by the thread only, as is counts_ except left_out
  RecorderCounts counts_;
  std::atomic<int> left_out_ = 0;
  std::atomic<bool> ended_early_ = false;
  std::atomic<bool> finished_ = false;
  Items ready_;
  Items free_;
  Items free_states_;
  std::mutex trouble_mutex_;
  std::optional<std::string> trouble_;
  std::thread thread_;  // last, as it uses the other members
};

/// A source that returns the items of `source` that the recorder accepted.
/// @param recorder  must outlive the source
[[nodiscard]] std::unique_ptr<FrameSource> recorded(std::unique_ptr<FrameSource> source,
                                                    Recorder& recorder);

/// The source that was given to recorded(). @pre `source` was returned by recorded()
[[nodiscard]] std::unique_ptr<FrameSource> unrecorded(std::unique_ptr<FrameSource> source);

}  // namespace palpable
