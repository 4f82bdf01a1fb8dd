#include "palpable/live/sources/source_guard.h"

#include "palpable/live/calibrate/calibration_check.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace palpable {

SourceGuard::SourceGuard(FrameSource& source) : source_(source) {
  if (const std::optional<double> baseline = baseline_of(source.format())) {
    reports_.push_back(fmt::format("the eyes are {} apart", baseline_text(*baseline)));
  }
}

FrameStatus SourceGuard::next(Frame& frame) {
  const FrameStatus status = source_.next(frame);
  watch_state();
  if (status == FrameStatus::kWaiting || status == FrameStatus::kEnd) return status;

  if (last_number_ >= 0 && frame.number > last_number_ + 1) {
    troubles_.dropped += frame.number - last_number_ - 1;
  }
  last_number_ = std::max(last_number_, frame.number);
  std::string trouble =
      status == FrameStatus::kFrame ? what_is_wrong_with(frame) : source_.last_trouble();
  if (status == FrameStatus::kFrame && trouble.empty()) {
    in_bad_row_ = false;
    return FrameStatus::kFrame;
  }
  ++troubles_.unreadable;
  last_trouble_ = std::move(trouble);
  if (!std::exchange(in_bad_row_, true)) {
    report(fmt::format("frame {} is left out: {}", frame.number, last_trouble_));
  }
  return FrameStatus::kUnreadable;
}

namespace {

// Sets invalid depths to unknown. If more than 1 % are invalid, the image counts as garbage.
std::string depth_trouble(DepthImage& depth) {
  constexpr std::size_t kFew = 100;  // 1 / largest share of invalid pixels
  std::size_t impossible = 0;
  for (float& Z : depth) {
    if (std::isnan(Z) || (Z > 0 && !std::isinf(Z))) continue;
    Z = std::numeric_limits<float>::quiet_NaN();
    ++impossible;
  }
  if (impossible * kFew <= depth.size()) return {};
  return fmt::format("{} of its {} depths are negative, 0 or infinite", impossible, depth.size());
}

}  // namespace

std::string wrong_size(const Frame& frame, const FrameFormat& format) {
  const std::pair color_size{format.width, format.height};
  const auto trouble_of = [](const char* what, const auto& image,
                             const std::pair<int, int>& size) -> std::string {
    if (std::pair(image.width(), image.height()) == size) return {};
    return fmt::format("its {} image is {} x {} px, not {} x {}", what, image.width(),
                       image.height(), size.first, size.second);
  };
  const bool stereo = format.kind == FrameFormat::Kind::kStereo;
  // YUYV: as many pairs of pixels as one eye has pixels
  const bool together = stereo && !frame.both.empty();
  if (together) return trouble_of("side-by-side", frame.both, color_size);
  std::string trouble = trouble_of(stereo ? "left" : "colour", frame.left, color_size);
  if (!trouble.empty()) return trouble;
  return stereo ? trouble_of("right", frame.right, color_size)
                : trouble_of("depth", frame.depth, depth_size_of(format));
}

std::string SourceGuard::what_is_wrong_with(Frame& frame) {
  const FrameFormat& format = source_.format();
  std::string trouble = wrong_size(frame, format);
  if (trouble.empty() && format.kind == FrameFormat::Kind::kColorDepth) {
    trouble = depth_trouble(frame.depth);
  }
  if (trouble.empty()) trouble = time_trouble(frame);
  return trouble;
}

std::string SourceGuard::time_trouble(Frame& frame) {
  if (!std::isfinite(frame.time)) return "its time is not a number";
  constexpr double kLongestPeriod = 1;  // s; a longer one is a gap
  double time = frame.time + offset_;
  Odd odd = Odd::kNone;
  if (has_time_ && time <= last_time_) odd = Odd::kBehind;
  if (has_time_ && !may_jump_ && time > last_time_ + longest_gap_) odd = Odd::kAhead;
  if (odd != Odd::kNone) {
    odd_row_ = odd == odd_ && time > odd_time_ ? odd_row_ + 1 : 1;
    const double step = time - std::exchange(odd_time_, time);
    odd_ = odd;
    if (odd_row_ < kClockRestart) {
      if (odd == Odd::kBehind) ++troubles_.back_in_time;
      return fmt::format("it is from {:.3f} s, after one from {:.3f} s", time, last_time_);
    }
    if (odd == Odd::kBehind) {
      const double moved = last_time_ + period_ - time;
      offset_ += moved;
      time += moved;
      report(fmt::format("the source's clock began anew before frame {}; its times go on",
                         frame.number));
    } else {
      longest_gap_ = std::max(longest_gap_, 2 * step);
      report(fmt::format("the source's clock went on by {:.3f} s before frame {}",
                         time - last_time_, frame.number));
    }
  }
  odd_ = Odd::kNone;
  may_jump_ = false;
  if (has_time_ && time - last_time_ < kLongestPeriod) period_ = time - last_time_;
  has_time_ = true;
  last_time_ = time;
  frame.time = time;
  return {};
}

void SourceGuard::watch_state() {
  const SourceState now = source_.state();
  if (now == state_) return;
  const std::string after =
      last_number_ < 0 ? "before the first frame" : fmt::format("after frame {}", last_number_);
  const std::string why = source_.last_trouble().empty() ? "" : ": " + source_.last_trouble();
  switch (now) {
    case SourceState::kStalled:
      ++troubles_.stalls;
      report(fmt::format("no pictures {}{}", after, why));
      break;
    case SourceState::kGone:
      ++troubles_.losses;
      is_lost_ = true;
      report_always(fmt::format("the camera is gone {}{}; looking for it", after, why));
      break;
    case SourceState::kRunning:
      may_jump_ = true;
      if (std::exchange(is_lost_, false)) {
        report_always("pictures come again");
      } else {
        report("pictures come again");
      }
      break;
  }
  state_ = now;
}

void SourceGuard::report(std::string line) {
  if (reported_ == kMostReports) return;
  ++reported_;
  if (reported_ == kMostReports) line += "; further ones are only counted";
  reports_.push_back(std::move(line));
}

std::vector<std::string> SourceGuard::take_reports() {
  for (std::string& note : source_.take_notes()) reports_.push_back(std::move(note));
  return std::exchange(reports_, {});
}

}  // namespace palpable
