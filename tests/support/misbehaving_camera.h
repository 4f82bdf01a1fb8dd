/// @file
/// A camera that does everything a camera should not do, and then goes on: a finger sinks into a
/// sphere 0.4 m away, frame by frame, while pictures are late, missing, torn or gone.
#pragma once

#include "palpable/vision/frame_source.h"
#include "tests/support/seen_capsules.h"

#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace palpable::test {

/// What the camera does next.
enum class Act {
  kGood,        ///< a frame; the finger is 1 mm deeper for each
  kStall,       ///< nothing comes, the camera is there
  kDrop,        ///< a frame that nobody ever sees: its number is missing
  kResize,      ///< images of another size
  kNoDepth,     ///< colour without its depth
  kGarbage,     ///< says itself that it cannot be read
  kNoise,       ///< depths that are no depths: infinite, negative, 0
  kNoTime,      ///< a time that is no number
  kStuckClock,  ///< a time that is always the same
  kBackInTime,  ///< one frame from long ago
  kFarFuture,   ///< one frame from days ahead
  kNewClock,    ///< from here on times begin anew
  kLateClock,   ///< from here on times are a minute later
  kGone,        ///< the camera is not there
};

class MisbehavingCamera final : public FrameSource {
 public:
  static constexpr int kWidth = 161;
  static constexpr int kHeight = 121;

  explicit MisbehavingCamera(std::vector<Act> acts) : acts_(std::move(acts)) {
    format_.kind = FrameFormat::Kind::kColorDepth;
    format_.width = kWidth;
    format_.height = kHeight;
    format_.depth_camera = {kWidth, kHeight, 250, 250, 80, 60};
  }

  const FrameFormat& format() const override { return format_; }
  int frame_count() const override { return -1; }
  std::string last_trouble() const override { return trouble_; }
  bool is_live() const override { return true; }
  SourceState state() const override { return state_; }

  FrameStatus next(Frame& frame) override {
    while (at_ < acts_.size() && acts_[at_] == Act::kDrop) {
      ++at_;
      ++number_;
    }
    if (at_ == acts_.size()) return FrameStatus::kEnd;
    const Act act = acts_[at_];
    if (!repeats_last || at_ + 1 < acts_.size()) ++at_;
    if (act == Act::kStall || act == Act::kGone) {
      state_ = act == Act::kGone ? SourceState::kGone : SourceState::kStalled;
      trouble_ = act == Act::kGone ? "no such device" : "";
      return FrameStatus::kWaiting;
    }
    state_ = SourceState::kRunning;
    frame.number = number_++;
    if (act == Act::kNewClock) {
      clock_begin_ = frame.number;
      late_ = 0;
    }
    if (act == Act::kLateClock) late_ += 60;
    frame.time = (frame.number - clock_begin_) / 30.0 + late_;
    if (act == Act::kGarbage) {
      trouble_ = "the picture is cut off";
      return FrameStatus::kUnreadable;
    }
    if (act == Act::kGood || act == Act::kNewClock) ++depth_mm_;
    const double y = -0.062 + 0.001 * depth_mm_;
    frame.left = ColorImage(kWidth, kHeight, Rgb{50, 60, 70});
    frame.depth = depth_of({{{0, y, 0.4}, {0, y - 0.1, 0.38}, 0.009}}, format_.depth_camera);
    switch (act) {
      case Act::kResize:
        frame.left = ColorImage(kWidth / 2, kHeight, Rgb{});
        break;
      case Act::kNoDepth:
        frame.depth = DepthImage();
        break;
      case Act::kNoTime:
        frame.time = std::numeric_limits<double>::quiet_NaN();
        break;
      case Act::kStuckClock:
        frame.time = -1;
        break;
      case Act::kBackInTime:
        frame.time -= 5;
        break;
      case Act::kFarFuture:
        frame.time += 1e6;
        break;
      case Act::kNoise: {
        constexpr std::array kBad{std::numeric_limits<float>::infinity(), -1.0F, 0.0F};
        std::size_t i = 0;
        for (float& Z : frame.depth) Z = kBad[i++ % kBad.size()];
        break;
      }
      default:
        break;
    }
    return FrameStatus::kFrame;
  }

  bool repeats_last = false;  ///< the last act for ever, instead of the end

 private:
  FrameFormat format_;
  std::vector<Act> acts_;
  std::size_t at_ = 0;
  int number_ = 0;
  int clock_begin_ = 0;
  double late_ = 0;  // s
  int depth_mm_ = 0;
  SourceState state_ = SourceState::kRunning;
  std::string trouble_;
};

}  // namespace palpable::test
