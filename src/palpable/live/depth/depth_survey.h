/// @file
/// The depths of a whole run: their range, how much of them could be used, and warnings where the
/// unit, the order of bytes or the calibration is probably wrong.
#pragma once

#include "palpable/common/geometry/frame.h"
#include "palpable/live/depth/measured_depth.h"
#include "palpable/live/depth/seen_frame.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace palpable {

/// The median of shares from 0 to 1, to a thousandth; without memory for each of them.
class ShareMedian {
 public:
  void add(double share);
  [[nodiscard]] double median() const;  ///< 0 without shares

 private:
  static constexpr std::size_t kBins = 1001;
  std::array<std::uint32_t, kBins> bins_{};
  std::uint64_t count_ = 0;
};

struct DepthFigures {
  double median = 0, low = 0, high = 0;  ///< m: 50, 5 and 95 % of all that was measured
  double measured = 0;                   ///< median share of the pixels that were measured
  double kept = 0;                       ///< median share of the pixels of `depth` that are known
  double unit = 0;                       ///< m, FrameFormat::depth_unit
  bool unit_assumed = false;
};

/// Watches the frames of one source. A warning comes once, when it is certain:
///
///     bytes     more than half of all changes between neighbours are multiples of 256 steps:
///               the bytes of each number are swapped, or the unit is 1/256
///     divisor   all numbers are multiples of 4 or more, and nothing states the unit
///     range     nothing from 0.1 to 5 m for 30 frames (or in all of a shorter run), unless the rig
///               has a baseline of 0.2 m or more, as on cars, which see farther
///     few       less than 5 % of the pixels kept for 30 frames (or in all of a shorter run)
///
/// add() allocates memory only in a frame in which a warning comes.
class DepthSurvey {
 public:
  DepthSurvey() = default;
  /// @param name       of the source, with which warnings begin
  /// @param rectified  DepthCamera::rectified()
  DepthSurvey(std::string name, const FrameFormat& format, const RectifiedStereo* rectified);

  void add(const SeenFrame& seen);
  /// The source has ended: judges what a short run has shown. Calling it again adds nothing.
  void finish();
  /// The warnings since the last call, a line each: "warning: ...".
  [[nodiscard]] std::vector<std::string> take_warnings();

  [[nodiscard]] int frames() const { return frames_; }
  [[nodiscard]] DepthFigures figures() const;

 private:
  /// The last frame's shares, for messages.
  struct Shares {
    double measured = 0, too_close = 0, too_far = 0, kept = 0;
  };
  void judge_steps();
  void judge_range(bool at_end);
  void judge_kept(bool at_end);
  void warn(const std::string& text);
  [[nodiscard]] std::string median_text() const;

  std::string name_;
  bool is_sensor_ = false;
  double baseline_ = 0;  // m, of stereo; 0: unknown
  double unit_ = 0;
  bool unit_assumed_ = false;

  int frames_ = 0;
  DepthBins bins_;
  DepthSteps steps_;
  ShareMedian measured_, kept_;
  Shares last_;
  int outside_ = 0;           // successive frames with depths of which none is in the scene's range
  bool ever_inside_ = false;  // some frame had one
  int few_ = 0;               // successive frames of which hardly anything was kept
  bool ever_enough_ = false;  // of some frame enough was kept
  bool said_unit_ = false, said_few_ = false;
  std::vector<std::string> warnings_;
};

/// "depth: measured in 93 % of the pixels, ..." for the summary of a run, with its line break.
[[nodiscard]] std::string text_of(const DepthFigures& figures);

}  // namespace palpable
