#include "palpable/live/sources/read_ahead.h"

#include <fmt/core.h>

#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

namespace palpable {
namespace {

class ReadAhead final : public FrameSource {
 public:
  explicit ReadAhead(std::unique_ptr<FrameReader> reader)
      : reader_(std::move(reader)),
        format_(reader_->format()),
        count_(reader_->count()),
        notes_(reader_->notes()),
        thread_([this] { run(); }) {}

  ReadAhead(const ReadAhead&) = delete;
  ReadAhead& operator=(const ReadAhead&) = delete;

  ~ReadAhead() override {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }

  const FrameFormat& format() const override { return format_; }
  int frame_count() const override { return count_; }
  std::string last_trouble() const override { return last_trouble_; }
  std::vector<std::string> take_notes() override { return std::exchange(notes_, {}); }
  SourceState state() const override { return state_; }

  FrameStatus next(Frame& frame) override {
    if (ended_) return FrameStatus::kEnd;
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return is_full_; });
    const FrameStatus status = status_;
    ended_ = status == FrameStatus::kEnd;
    if (!ended_) std::swap(frame, ahead_);  // the loop's old images are reused for the next frame
    std::string trouble = std::exchange(trouble_, {});
    state_ = ahead_state_;
    is_full_ = false;
    lock.unlock();
    changed_.notify_all();
    const bool in_trouble = status == FrameStatus::kUnreadable || status == FrameStatus::kWaiting;
    if (in_trouble) last_trouble_ = std::move(trouble);
    return status;
  }

 private:
  void run() {
    FrameStatus status = FrameStatus::kFrame;
    for (int number = 0; status != FrameStatus::kEnd; ++number) {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return stop_ || !is_full_; });
      if (stop_) return;
      // While `full_` is false, `ahead_` and `trouble_` belong to this thread.
      lock.unlock();
      std::string trouble;
      try {
        status = reader_->read(number, ahead_, trouble);
      } catch (const std::exception& e) {  // e.g. out of memory
        ahead_.number = number;
        status = count_ >= 0 && number >= count_ ? FrameStatus::kEnd : FrameStatus::kUnreadable;
        trouble = fmt::format("frame {} cannot be read: {}", number, e.what());
      }
      lock.lock();
      status_ = status;
      ahead_state_ = reader_->state();
      trouble_ = std::move(trouble);
      is_full_ = true;
      lock.unlock();
      changed_.notify_all();
    }
  }

  std::unique_ptr<FrameReader> reader_;  // used by the thread only
  FrameFormat format_;
  int count_ = 0;
  std::vector<std::string> notes_;
  bool ended_ = false;
  std::string last_trouble_;
  SourceState state_ = SourceState::kRunning;

  std::mutex mutex_;
  std::condition_variable changed_;
  bool stop_ = false;
  bool is_full_ = false;
  FrameStatus status_ = FrameStatus::kEnd;
  SourceState ahead_state_ = SourceState::kRunning;
  Frame ahead_;
  std::string trouble_;
  std::thread thread_;  // last, as it uses the other members
};

}  // namespace

std::unique_ptr<FrameSource> read_ahead(std::unique_ptr<FrameReader> reader) {
  return std::make_unique<ReadAhead>(std::move(reader));
}

}  // namespace palpable
