#include "palpable/live/player/recorder.h"

#include "palpable/common/base/contract.h"
#include "palpable/live/sources/source_guard.h"

#include <fmt/core.h>

#include <chrono>
#include <utility>

namespace palpable {

std::string lost_of_recording(const std::filesystem::path& file, const RecorderCounts& counts) {
  const auto lost = [&](const std::string& why) {
    return fmt::format("{}; {} frames were written to {}, which was changed while it was recorded",
                       why, counts.frames, file.string());
  };
  if (counts.ended_early && counts.frames == 0) return {};  // nothing was written
  const Result<RecordingContents> there = read_recording(file);
  if (!there.ok()) return lost(there.problem().message);
  const RecordingContents& found = there.value();
  RunHash states;
  for (const RecordedState& state : found.states) states.add(state.hash);
  if (found.damaged) return lost(fmt::format("{}: {}", file.string(), found.ending));
  if (found.frames == counts.frames && states.count() == counts.states.count() &&
      states.text() == counts.states.text() && found.finished != counts.ended_early) {
    return {};
  }
  return lost(fmt::format("{}: holds {} frames and other states", file.string(), found.frames));
}

Recorder::Recorder(const std::filesystem::path& file, const FrameFormat& format, const Json& run,
                   Opening opening)
    : path_(file),
      writer_(file, format, run, opening),
      ready_(kFrames + kStates),
      free_(kFrames),
      free_states_(kStates) {
  for (std::size_t k = 0; k < kFrames; ++k) free_.push(std::make_unique<Item>());
  for (std::size_t k = 0; k < kStates; ++k) free_states_.push(std::make_unique<Item>());
  thread_ = std::thread([this] { run_thread(); });
}

Recorder::~Recorder() {
  if (thread_.joinable()) finish_thread();
}

void Recorder::finish_thread() {
  free_.close();
  free_states_.close();
  ready_.close();
  thread_.join();
}

// Passes an item of the source to the thread, or returns false if there is no room for it, in which
// case the source drops its frame.
// @param fill  sets the item's content; the item reuses its memory
template <class Fill>
bool Recorder::add_of_source(bool waits, const Fill& fill) {
  if (is_over()) return true;
  std::optional<std::unique_ptr<Item>> item =
      waits ? free_.pop() : free_.pop_within(std::chrono::duration<double>(0));
  if (!item) return is_over();
  fill(**item);
  ready_.push(std::move(*item));
  return true;
}

// The same for an item of the loop, which waits for room.
template <class Fill>
void Recorder::add_of_loop(const Fill& fill) {
  if (is_over()) return;
  std::optional<std::unique_ptr<Item>> item = free_states_.pop();
  if (!item) return;
  fill(**item);
  ready_.push(std::move(*item));
}

bool Recorder::add_frame(const Frame& frame, std::optional<double> taken, bool waits) {
  const bool added = add_of_source(waits, [&](Item& item) {
    item.kind = Item::Kind::kFrame;
    item.frame = frame;
    item.taken = taken;
  });
  left_out_ += !added;
  return added;
}

bool Recorder::add_unreadable(int number, std::string_view why, bool waits) {
  const bool added = add_of_source(waits, [&](Item& item) {
    item.kind = Item::Kind::kUnreadable;
    item.frame.number = number;
    item.why = why;
  });
  left_out_ += !added;
  return added;
}

bool Recorder::add_silence(SourceState state, std::string_view why, bool waits) {
  return add_of_source(waits, [&](Item& item) {
    item.kind = Item::Kind::kSilence;
    item.silence = state;
    item.why = why;
  });
}

void Recorder::add_refinement(bool asked, const Eigen::Matrix3Xf* exact) {
  add_of_loop([&](Item& item) {
    item.kind = Item::Kind::kRefinement;
    item.refinement.asked = asked;
    if (exact != nullptr) {
      item.refinement.exact = *exact;
    } else {
      item.refinement.exact.resize(3, 0);
    }
  });
}

void Recorder::add_state(int number, std::uint64_t hash, std::string_view line) {
  add_of_loop([&](Item& item) {
    item.kind = Item::Kind::kState;
    item.state.number = number;
    item.state.hash = hash;
    item.state.line = line;
  });
}

void Recorder::run_thread() {
  while (std::optional<std::unique_ptr<Item>> item = ready_.pop()) {
    try {
      if (!ended_early_) write(**item);
    } catch (const std::exception& error) { end_early(error.what()); }
    const bool of_answers =
        (*item)->kind == Item::Kind::kState || (*item)->kind == Item::Kind::kRefinement;
    Items& free = of_answers ? free_states_ : free_;
    free.push(std::move(*item));
  }
}

void Recorder::write(const Item& item) {
  switch (item.kind) {
    case Item::Kind::kFrame:
      writer_.add_frame(item.frame, item.taken);
      ++counts_.frames;
      break;
    case Item::Kind::kUnreadable:
      writer_.add_unreadable(item.frame.number, item.why);
      break;
    case Item::Kind::kSilence:
      writer_.add_silence(item.silence, item.why);
      break;
    case Item::Kind::kRefinement:
      writer_.add_refinement(item.refinement);
      break;
    case Item::Kind::kState:
      writer_.add_state(item.state);
      counts_.states.add(item.state.hash);
      break;
  }
}

// The chunks written before remain readable.
void Recorder::end_early(const std::string& why) {
  ended_early_ = true;
  const std::lock_guard lock(trouble_mutex_);
  trouble_ =
      fmt::format("{}; the recording ends after {} frames, the run goes on", why, counts_.frames);
}

RecorderCounts Recorder::finish() {
  finished_ = true;
  finish_thread();
  try {
    if (!ended_early_) writer_.finish();
  } catch (const Error& error) { end_early(error.what()); }
  counts_.left_out = left_out_;
  counts_.bytes = writer_.size();
  counts_.ended_early = ended_early_;
  return counts_;
}

std::optional<std::string> Recorder::take_trouble() {
  const std::lock_guard lock(trouble_mutex_);
  return std::exchange(trouble_, std::nullopt);
}

namespace {

class RecordedSource final : public FrameSource {
 public:
  RecordedSource(std::unique_ptr<FrameSource> source, Recorder& recorder)
      : source_(std::move(source)), recorder_(recorder), waits_(!source_->is_live()) {}

  const FrameFormat& format() const override { return source_->format(); }
  int frame_count() const override { return source_->frame_count(); }
  std::vector<std::string> take_notes() override { return source_->take_notes(); }
  std::string last_trouble() const override { return trouble_; }
  bool is_live() const override { return !waits_; }
  std::optional<double> taken() const override { return source_->taken(); }
  /// Changes of the camera's state are passed on only after they are recorded, because the loop's
  /// treatment of the next frame's time depends on them.
  SourceState state() const override { return state_; }

  FrameStatus next(Frame& frame) override {
    FrameStatus status = source_->next(frame);
    if (status == FrameStatus::kEnd) return status;
    if (status != FrameStatus::kFrame) trouble_ = source_->last_trouble();
    // A frame of the wrong size is recorded as unreadable, as the loop treats it.
    if (status == FrameStatus::kFrame) {
      std::string wrong = wrong_size(frame, format());
      if (!wrong.empty()) {
        trouble_ = std::move(wrong);
        status = FrameStatus::kUnreadable;
      }
    }
    if (!pass_state_on()) return FrameStatus::kWaiting;
    if (status == FrameStatus::kWaiting) return status;
    const bool is_recorded = status == FrameStatus::kFrame
                                 ? recorder_.add_frame(frame, source_->taken(), waits_)
                                 : recorder_.add_unreadable(frame.number, trouble_, waits_);
    return is_recorded ? status : FrameStatus::kWaiting;
  }

  std::unique_ptr<FrameSource> release() { return std::move(source_); }

 private:
  // The return to kRunning is recorded with the first frame after it. @return whether the item that
  // has just come may be recorded: false if there was no room for the change of state before it
  bool pass_state_on() {
    const SourceState now = source_->state();
    if (now == state_) return true;
    if (now != SourceState::kRunning && !recorder_.add_silence(now, trouble_, waits_)) return false;
    state_ = now;
    return true;
  }

  std::unique_ptr<FrameSource> source_;
  Recorder& recorder_;
  bool waits_;
  SourceState state_ = SourceState::kRunning;
  std::string trouble_;
};

}  // namespace

std::unique_ptr<FrameSource> recorded(std::unique_ptr<FrameSource> source, Recorder& recorder) {
  return std::make_unique<RecordedSource>(std::move(source), recorder);
}

std::unique_ptr<FrameSource> unrecorded(std::unique_ptr<FrameSource> source) {
  auto* recorded = dynamic_cast<RecordedSource*>(source.get());
  PALPABLE_EXPECT(recorded != nullptr, "recorded() made the source");
  return recorded->release();
}

}  // namespace palpable
