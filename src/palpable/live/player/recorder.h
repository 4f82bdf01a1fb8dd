/// @file
/// Records a run while it goes on, on a thread of its own.
///
///     source ──> recorded() ──────────────────────────> loop ──> state ──┐
///                   └─ copy ─> queue ─> thread: pack, write <────────────┘
///
/// What the disk has no time for is not given to the loop either, where frames come at their own
/// pace; a source that waits for its reader waits for the disk. So the loop runs on what was
/// recorded, and a replay answers the same frames.
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
  int frames = 0;           ///< in the file
  int left_out = 0;         ///< not even given to the loop: the disk was behind
  std::uint64_t bytes = 0;  ///< of the file
  RunHash states;           ///< of those that are in the file
};

/// Where the disk does not take it (it is full), the recording ends with its last whole chunk, and
/// the run goes on without: take_trouble() says so once.
class Recorder {
 public:
  /// Begins the file. @param run  what a replay is to know
  /// @throws Error when it cannot be written
  Recorder(const std::filesystem::path& file, const FrameFormat& format, const Json& run);
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;
  /// Ends the thread; without finish() the file is one that was cut off.
  ~Recorder();

  /// Frames that may wait for the disk: 0.2 s of a camera's, 33 MB at 720p.
  static constexpr std::size_t kFrames = 6;

  /// On the source's thread: whether there was room for a copy of what it gave. Where it is to wait
  /// for room there always is, and once the recording has ended early, too.
  bool add_frame(const Frame& frame, std::optional<double> taken, bool waits);
  bool add_unreadable(int number, std::string_view why, bool waits);
  bool add_silence(SourceState state, std::string_view why, bool waits);
  /// On the thread that answers: what a second process had to do with the frame whose state is
  /// added next. @param exact  null: nothing was taken up
  void add_refinement(bool asked, const Eigen::Matrix3Xf* exact);
  /// On the thread that answers: what became of a frame.
  /// @param line  of docs/touch_events.md
  void add_state(int number, std::uint64_t hash, std::string_view line);

  /// Writes what waits, and ends the file. Frames that come later pass by.
  RecorderCounts finish();
  /// Why the recording has ended early, once.
  [[nodiscard]] std::optional<std::string> take_trouble();

 private:
  // Frames and what else a source gives go round in one ring, states in another: a source that is
  // quick takes no room from the thread that answers.
  struct Item {
    enum class Kind { kFrame, kUnreadable, kSilence, kRefinement, kState } kind = Kind::kFrame;
    Frame frame;  // of kUnreadable its number
    std::optional<double> taken;
    SourceState silence = SourceState::kStalled;
    std::string why;
    RecordedState state;
    RecordedRefinement refinement;
  };
  using Items = BoundedQueue<std::unique_ptr<Item>>;

  [[nodiscard]] bool is_over() const { return ended_early_ || finished_; }
  [[nodiscard]] std::unique_ptr<Item> room(bool waits);
  void run_thread();
  void finish_thread();
  void write(const Item& item);
  void end_early(const std::string& why);

  static constexpr std::size_t kStates = 64;
  std::filesystem::path path_;
  RecordingWriter writer_;  // the thread's alone, as is counts_ but for left_out_
  RecorderCounts counts_;
  std::atomic<int> left_out_ = 0;
  std::atomic<bool> ended_early_ = false;
  std::atomic<bool> finished_ = false;
  Items ready_;
  Items free_;
  Items free_states_;
  std::mutex trouble_mutex_;
  std::optional<std::string> trouble_;
  std::thread thread_;  // last: it uses all of the above
};

/// A source that gives what `source` gives, as far as the recorder has it.
/// @param recorder  must outlive it
[[nodiscard]] std::unique_ptr<FrameSource> recorded(std::unique_ptr<FrameSource> source,
                                                    Recorder& recorder);

/// The source that recorded() was given. @pre `source` comes from there
[[nodiscard]] std::unique_ptr<FrameSource> unrecorded(std::unique_ptr<FrameSource> source);

}  // namespace palpable
