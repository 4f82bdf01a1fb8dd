/// @file
/// A camera with all malfunctions of real ones, which continues after each. Its pictures show a
/// finger that penetrates a sphere 0.4 m away more in every frame. In a room the camera also
/// moves to the right.
#pragma once

#include "palpable/live/sources/frame_source.h"
#include "tests/support/seen_capsules.h"
#include "tests/support/seen_wall.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace palpable::test {

/// The next event of the camera.
enum class Act {
  kGood,         ///< a frame; the finger is 1 mm deeper each time
  kStall,        ///< no picture comes, the camera is connected
  kDrop,         ///< a frame is lost: its number is missing
  kResize,       ///< images of another size
  kRightResize,  ///< only the right eye's image has another size
  kNoDepth,      ///< colour without depth
  kGarbage,      ///< reported as unreadable
  kNoise,        ///< invalid depths: infinite, negative, 0
  kNoTime,       ///< the time is NaN
  kStuckClock,   ///< the time is the same again
  kBackInTime,   ///< one frame from long ago
  kFarFuture,    ///< one frame from days ahead
  kNewClock,     ///< from here on times restart
  kLateClock,    ///< from here on times are a minute later
  kGone,         ///< the camera is disconnected
};

/// The kind of pictures and their content.
enum class Shows {
  kFinger,      ///< colour + depth; nothing behind the finger, the camera is fixed
  kRoom,        ///< colour + depth; the wall of seen_wall.h, and the finger after 30 good frames
  kStereoRoom,  ///< the same scene as rectified pairs
};

class MisbehavingCamera final : public FrameSource {
 public:
  static constexpr int kWidth = 161;
  static constexpr int kHeight = 121;
  static constexpr double kBaseline = 0.06;  ///< m
  static constexpr double kStep = 0.001;  ///< m, motion to the right in each good frame of a room
  static constexpr int kAlone = 30;       ///< good frames of a room before the finger appears

  explicit MisbehavingCamera(std::vector<Act> acts, Shows shows = Shows::kFinger)
      : format_(wall_format()), shows_(shows), acts_(std::move(acts)) {
    if (shows == Shows::kStereoRoom) {
      format_.kind = FrameFormat::Kind::kStereo;
      format_.already_rectified = true;
      format_.rectified = {format_.depth_camera, kBaseline, 0};
    }
  }

  /// The camera's distance to the right of its first position, m, in the last frame returned.
  double x() const { return shows_ == Shows::kFinger ? 0 : kStep * (good_ - 1); }
  /// The pixel of the fingertip in the last frame returned.
  Eigen::Vector2d tip() const { return format_.depth_camera.project(finger(x()).a); }

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
    if (act == Act::kGood || act == Act::kNewClock) ++good_;
    picture(x(), frame.left, frame.depth);
    if (shows_ == Shows::kStereoRoom) picture(x() + kBaseline, frame.right, frame.depth);
    if (format_.kind == FrameFormat::Kind::kStereo) frame.depth = DepthImage();
    switch (act) {
      case Act::kResize:
        frame.left = ColorImage(kWidth / 2, kHeight, Rgb{});
        break;
      case Act::kRightResize:
        frame.right = ColorImage(kWidth / 2, kHeight, Rgb{});
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

  bool repeats_last = false;  ///< repeats the last act for ever

 private:
  // The finger for an eye `x` m to the right: 1 mm deeper in each good frame since its appearance.
  Capsule finger(double x) const {
    const double y = -0.062 + 0.001 * (good_ - (shows_ == Shows::kFinger ? 0 : kAlone));
    if (shows_ == Shows::kFinger) return {{0, y, 0.4}, {0, y - 0.1, 0.38}, 0.009};
    // Thick, because the picture has few pixels; not at the left, where a pair has no depth.
    return {{0.06 - x, y, 0.4}, {0.06 - x, y - 0.1, 0.38}, 0.015};
  }

  // The picture of such an eye.
  void picture(double x, ColorImage& color, DepthImage& depth) const {
    const bool room = shows_ != Shows::kFinger;
    const std::vector<Capsule> there =
        room && good_ <= kAlone ? std::vector<Capsule>{} : std::vector{finger(x)};
    depth = depth_of(there, format_.depth_camera);
    if (!room) {
      color = ColorImage(kWidth, kHeight, Rgb{50, 60, 70});
      return;
    }
    color = frame_of_wall(0, x).left;
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        if (std::isnan(depth(u, v))) {
          depth(u, v) = static_cast<float>(kWallZ);
          continue;
        }
        // Skin with a pattern that moves with the finger.
        const Eigen::Vector3d at =
            format_.depth_camera.unproject(u, v, static_cast<double>(depth(u, v))) -
            there.front().a;
        const double spots = 60 * std::sin(300 * at.x()) * std::sin(250 * at.y());
        color(u, v) = {200, static_cast<std::uint8_t>(150 + spots), 120};
      }
    }
  }

  FrameFormat format_;
  Shows shows_;
  std::vector<Act> acts_;
  std::size_t at_ = 0;
  int number_ = 0;
  int clock_begin_ = 0;
  double late_ = 0;  // s
  int good_ = 0;
  SourceState state_ = SourceState::kRunning;
  std::string trouble_;
};

}  // namespace palpable::test
