#include "palpable/vision/paced_source.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace palpable {
namespace {

class PacedSource final : public FrameSource {
 public:
  PacedSource(std::unique_ptr<FrameSource> source, WallClock& clock)
      : source_(std::move(source)), clock_(clock) {}

  const FrameFormat& format() const override { return source_->format(); }
  int frame_count() const override { return source_->frame_count(); }
  int unreadable_count() const override { return source_->unreadable_count(); }
  std::string last_trouble() const override { return source_->last_trouble(); }
  bool is_live() const override { return true; }
  SourceState state() const override { return source_->state(); }

  FrameStatus next(Frame& frame) override {
    if (!ahead_status_) read_ahead();
    if (ahead_status_ == FrameStatus::kEnd) return FrameStatus::kEnd;
    if (ahead_status_ != FrameStatus::kFrame) {
      std::swap(frame, ahead_);
      return *std::exchange(ahead_status_, std::nullopt);
    }
    if (!begin_) begin_ = clock_.now() - ahead_.time;
    const double wait = *begin_ + ahead_.time - clock_.now();
    if (wait > 0) clock_.sleep(std::min(wait, kLongestWait));
    if (wait > kLongestWait) return FrameStatus::kWaiting;
    do {
      std::swap(frame, ahead_);
      read_ahead();
    } while (ahead_status_ == FrameStatus::kFrame && *begin_ + ahead_.time <= clock_.now());
    return FrameStatus::kFrame;
  }

 private:
  void read_ahead() { ahead_status_ = source_->next(ahead_); }

  std::unique_ptr<FrameSource> source_;
  WallClock& clock_;
  std::optional<double> begin_;  // when the recording's time 0 was, on the clock
  Frame ahead_;
  std::optional<FrameStatus> ahead_status_;  // nothing: ahead_ is not filled
};

}  // namespace

std::unique_ptr<FrameSource> paced(std::unique_ptr<FrameSource> source, WallClock& clock) {
  return std::make_unique<PacedSource>(std::move(source), clock);
}

}  // namespace palpable
