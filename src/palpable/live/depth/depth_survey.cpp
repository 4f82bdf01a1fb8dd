#include "palpable/live/depth/depth_survey.h"

#include "palpable/common/base/order_statistics.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpable {
namespace {

constexpr int kLongEnough = 30;        // frames, a second of a camera
constexpr int kStepsKnown = 10;        // frames after which the numbers are judged
constexpr double kHardlyAny = 0.05;    // share of the pixels
constexpr double kNothingOf = 0.01;    // share of a frame's sample that counts as nothing
constexpr double kWideBaseline = 0.2;  // m, of rigs that look at streets rather than at desks

// Differences that are multiples of 256 are one in 256 by chance, and nine in ten where bytes are
// swapped (0.94 to 0.99 in recordings of four sensors).
constexpr double kMostChanges = 0.5;
constexpr std::uint64_t kLeastChanges = 200;
// Fewer different numbers may all be multiples of something by chance: two boards and a wall.
constexpr std::size_t kLeastKinds = 24;
// A flat desk has few numbers, too, but its noise changes them from pixel to pixel. Five or more
// that often change, and by multiples of 256 only, are neighbouring numbers with swapped bytes.
constexpr std::size_t kFewKinds = 5;
constexpr double kNearlyAllChanges = 0.99;
constexpr std::uint64_t kOften = 10;  // one change among as many values
constexpr std::uint64_t kLeastValues = 1000;
// 2 and 3 are left out: sensors with steps of 2 or 3 mm write millimetres, too.
constexpr int kLeastDivisor = 4;

std::string millimetres(double metres) { return fmt::format("{:.6g} mm", 1e3 * metres); }

// As --depth-unit takes it.
std::string unit_option(double metres) {
  return fmt::format("--depth-unit {:.6g}mm", 1e3 * metres);
}

std::string percent(double share) {
  return share > 0 && share < 0.01 ? "less than 1 %" : fmt::format("{:.0f} %", 100 * share);
}

}  // namespace

void ShareMedian::add(double share) {
  const double bin = std::round(std::clamp(share, 0.0, 1.0) * (kBins - 1));
  ++bins_[static_cast<std::size_t>(bin)];
  ++count_;
}

double ShareMedian::median() const {
  if (count_ == 0) return 0;
  return static_cast<double>(percentile_bin(bins_, count_, 0.5)) / (kBins - 1);
}

DepthSurvey::DepthSurvey(std::string name, const FrameFormat& format,
                         const RectifiedStereo* rectified)
    : name_(std::move(name)),
      is_sensor_(format.kind == FrameFormat::Kind::kColorDepth),
      baseline_(rectified != nullptr ? rectified->baseline : 0),
      unit_(format.depth_unit),
      unit_assumed_(format.depth_unit_assumed) {}

void DepthSurvey::add(const SeenFrame& seen) {
  const MeasuredDepth& depth = seen.measured;
  ++frames_;
  last_ = {depth.measured, depth.too_close, depth.too_far, depth.kept};
  measured_.add(depth.measured);
  kept_.add(depth.kept);
  bins_.add(depth.bins);
  steps_.add(depth.steps);
  // A frame whose depths are all too close, such as a hand on the lens, shows nothing of the unit.
  if (depth.measured - depth.too_close >= kHardlyAny && depth.bins.count() > 0) {
    const auto inside = static_cast<double>(depth.in_scene);
    const bool is_outside = inside < kNothingOf * static_cast<double>(depth.bins.count());
    outside_ = is_outside ? outside_ + 1 : 0;
    ever_inside_ |= !is_outside;
  }
  few_ = depth.kept < kHardlyAny ? few_ + 1 : 0;
  ever_enough_ |= few_ == 0;
  if (frames_ == kStepsKnown) judge_steps();
  judge_range(false);
  judge_kept(false);
}

void DepthSurvey::finish() {
  judge_steps();
  judge_range(true);
  judge_kept(true);
}

std::vector<std::string> DepthSurvey::take_warnings() { return std::exchange(warnings_, {}); }

void DepthSurvey::judge_steps() {
  if (said_unit_ || unit_ <= 0) return;
  const std::size_t kinds = steps_.kinds.count();
  const bool is_flat = kinds < kLeastKinds;
  if (kinds < kFewKinds || (is_flat && kOften * steps_.changes < steps_.values)) return;
  const double enough = is_flat ? kNearlyAllChanges : kMostChanges;
  const bool all_by_256 =
      static_cast<double>(steps_.values_by_256) > 0.99 * static_cast<double>(steps_.values);
  const bool jumps =
      steps_.changes >= kLeastChanges &&
      static_cast<double>(steps_.changes_by_256) > enough * static_cast<double>(steps_.changes);
  if (jumps && all_by_256 && unit_assumed_) {
    warn(
        fmt::format("its depths are multiples of 256 steps ({}): the two bytes of each number are "
                    "swapped, or a step is not {} but a 256th of it ({})",
                    median_text(), millimetres(unit_), unit_option(unit_ / 256)));
    said_unit_ = true;
  } else if (jumps && !all_by_256) {
    warn(
        fmt::format("its neighbouring depths differ by multiples of 256 steps ({}): the two bytes "
                    "of each number are swapped; write the images with the bytes in order",
                    median_text()));
    said_unit_ = true;
  } else if (unit_assumed_ && !is_flat && steps_.values >= kLeastValues &&
             steps_.divisor >= kLeastDivisor) {
    warn(
        fmt::format("all of its depths are multiples of {} steps ({}): is a step another unit "
                    "than {}, which is assumed? {:.0f} steps in a metre are {}; {} if it is right",
                    steps_.divisor, median_text(), millimetres(unit_), steps_.divisor / unit_,
                    unit_option(unit_ / steps_.divisor), unit_option(unit_)));
    said_unit_ = true;
  }
}

void DepthSurvey::judge_range(bool at_end) {
  if (said_unit_ || baseline_ >= kWideBaseline) return;
  const bool whole_run = at_end && outside_ > 0 && !ever_inside_;
  if (outside_ < kLongEnough && !whole_run) return;
  said_unit_ = true;
  std::string cause;
  if (!is_sensor_) {
    cause = fmt::format("is the baseline of the calibration, {}, in the right unit?",
                        millimetres(baseline_));
  } else if (unit_ > 0) {
    cause = fmt::format(
        "is a step another unit than {}{} (--depth-unit, unit_m in "
        "intrinsics.txt), or are the bytes of each number swapped?",
        millimetres(unit_), unit_assumed_ ? ", which is assumed" : "");
  } else {
    cause = "are they in the right unit?";
  }
  warn(fmt::format("it has no depths from {:g} to {:g} m in {} frames ({}): {}", 0.1, 5.0, outside_,
                   median_text(), cause));
}

void DepthSurvey::judge_kept(bool at_end) {
  if (said_few_) return;
  const bool whole_run = at_end && few_ > 0 && !ever_enough_;
  if (few_ < kLongEnough && !whole_run) return;
  said_few_ = true;
  std::string text = fmt::format(
      "depth was measured in {} of the pixels and kept in {}, in {} "
      "frames",
      percent(last_.measured), percent(last_.kept), few_);
  if (last_.measured < kHardlyAny) {
    text += is_sensor_ ? ": are these its depth images? 0 and 65535 are no depths"
                       : ": dark, plain or blurred, or the calibration is another camera's";
    return warn(text);
  }
  text += fmt::format(
      ": {} are nearer than the searched range, {} beyond the largest depth "
      "(--farthest)",
      percent(last_.too_close), percent(last_.too_far));
  text += is_sensor_ ? "; is the unit of the depth right (--depth-unit), and color_from_depth of "
                       "intrinsics.txt?"
                     : fmt::format(
                           "; is the calibration this camera's, and its baseline, {}, in "
                           "the right unit?",
                           millimetres(baseline_));
  warn(text);
}

void DepthSurvey::warn(const std::string& text) {
  warnings_.push_back(fmt::format("warning: {}{}{}", name_, name_.empty() ? "" : ": ", text));
}

std::string DepthSurvey::median_text() const {
  return fmt::format("median {:.3g} m", bins_.percentile(0.5));
}

DepthFigures DepthSurvey::figures() const {
  constexpr double kLow = 0.05, kHigh = 0.95;
  return {bins_.percentile(0.5), bins_.percentile(kLow), bins_.percentile(kHigh),
          measured_.median(),    kept_.median(),         unit_,
          unit_assumed_};
}

std::string text_of(const DepthFigures& figures) {
  std::string text = fmt::format("depth: measured in {} of the pixels, kept in {}",
                                 percent(figures.measured), percent(figures.kept));
  if (figures.median > 0) {
    text += fmt::format("; median {:.3g} m, {:.3g} to {:.3g} m (5 to 95 %)", figures.median,
                        figures.low, figures.high);
  }
  if (figures.unit > 0) {
    text += fmt::format("; a step is {}{}", millimetres(figures.unit),
                        figures.unit_assumed ? ", which is assumed" : "");
  }
  return text + "\n";
}

}  // namespace palpable
