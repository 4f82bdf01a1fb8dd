#include "palpable/live/sources/paced_source.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace palpable {
namespace {

class PacedSource final : public FrameSource {
 public:
  PacedSource(std::unique_ptr<FrameSource> source, WallClock& clock, Late late)
      : source_(std::move(source)), clock_(clock), skips_(late == Late::kSkipped) {}

  const FrameFormat& format() const override { return source_->format(); }
  int frame_count() const override { return source_->frame_count(); }
  std::string last_trouble() const override { return source_->last_trouble(); }
  std::vector<std::string> take_notes() override { return source_->take_notes(); }
  bool is_live() const override { return skips_; }
  SourceState state() const override { return state_; }
  std::optional<double> taken() const override { return taken_; }

  FrameStatus next(Frame& frame) override {
    if (!ahead_status_) read_ahead();
    if (ahead_status_ == FrameStatus::kEnd) return FrameStatus::kEnd;
    if (ahead_status_ != FrameStatus::kFrame) {
      std::swap(frame, ahead_);
      state_ = source_->state();
      return *std::exchange(ahead_status_, std::nullopt);
    }
    const double wait = *due_ - clock_.now();
    if (wait > 0) clock_.sleep(std::min(wait, kLongestWait));
    if (wait > kLongestWait) return FrameStatus::kWaiting;
    do {
      taken_ = due_;
      std::swap(frame, ahead_);
      state_ = source_->state();
      read_ahead();
    } while (skips_ && ahead_status_ == FrameStatus::kFrame && *due_ <= clock_.now());
    return FrameStatus::kFrame;
  }

 private:
  void read_ahead() {
    // Longer gaps of a recording are shortened to this, so that a wrong time cannot stop it.
    constexpr double kLongestStep = 2;  // s
    ahead_status_ = source_->next(ahead_);
    if (ahead_status_ != FrameStatus::kFrame || !std::isfinite(ahead_.time)) {
      if (!due_) due_ = clock_.now();
      return;
    }
    const double step = ahead_.time - last_time_.value_or(ahead_.time);
    due_ = due_.value_or(clock_.now()) + std::clamp(step, 0.0, kLongestStep);
    last_time_ = ahead_.time;
  }

  std::unique_ptr<FrameSource> source_;
  WallClock& clock_;
  bool skips_;
  Frame ahead_;
  std::optional<FrameStatus> ahead_status_;    // empty: ahead_ is not filled
  SourceState state_ = SourceState::kRunning;  // of the last returned frame, not of ahead_
  std::optional<double> due_;                  // clock time at which the last frame read is due
  std::optional<double> last_time_;            // Frame::time of that frame
  std::optional<double> taken_;                // when the returned frame was due
};

}  // namespace

std::unique_ptr<FrameSource> paced(std::unique_ptr<FrameSource> source, WallClock& clock,
                                   Late late) {
  return std::make_unique<PacedSource>(std::move(source), clock, late);
}

}  // namespace palpable
