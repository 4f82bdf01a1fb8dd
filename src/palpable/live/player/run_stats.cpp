#include "palpable/live/player/run_stats.h"

#include "palpable/common/base/order_statistics.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

constexpr double kShortest = 1e-3;  // ms
constexpr double kWider = 1.02;     // ratio of the widths of neighbouring bins

std::size_t bin_of(double ms, std::size_t bins) {
  if (!(ms > kShortest)) return 0;
  const double bin = std::log(ms / kShortest) / std::log(kWider);
  return static_cast<std::size_t>(std::min(bin, static_cast<double>(bins - 1)));
}

}  // namespace

void DurationBins::add(double ms) {
  ++bins_[bin_of(ms, kBins)];
  ++count_;
}

void DurationBins::clear() {
  bins_.fill(0);
  count_ = 0;
}

double DurationBins::percentile(double share) const {
  if (count_ == 0) return 0;
  const auto bin = static_cast<double>(percentile_bin(bins_, count_, share));
  return kShortest * std::pow(kWider, bin + 0.5);  // centre of the bin
}

void RunStats::add(const StageTimes& times, double age_ms) {
  all_.add(times, age_ms);
  recent_.add(times, age_ms);
}

RunFigures RunStats::end_stretch(const RunMoment& now) {
  RunFigures figures = recent_.figures(now);
  recent_.restart(now);
  return figures;
}

void RunStats::Stretch::add(const StageTimes& times, double age_ms) {
  ++frames;
  if (!std::isnan(age_ms)) age.add(age_ms);
  for (const StageTime& stage : times.stages()) {
    const auto end = names.begin() + static_cast<std::ptrdiff_t>(stage_count);
    const auto known = std::find(names.begin(), end, stage.name);
    const auto at = static_cast<std::size_t>(known - names.begin());
    if (at == names.size()) continue;  // no room for more stages: it is not counted
    if (known == end) names[stage_count++] = stage.name;
    stages[at].add(stage.ms);
  }
}

RunFigures RunStats::Stretch::figures(const RunMoment& now) const {
  RunFigures result;
  result.frames = frames;
  const double wall = now.now - begin.now;
  const auto count = static_cast<double>(frames);
  if (wall > 0) result.frames_per_second = count / wall;
  result.age_p50_ms = age.percentile(0.5);
  result.age_p99_ms = age.percentile(0.99);
  result.dropped = now.dropped - begin.dropped;
  result.left_out = now.left_out - begin.left_out;
  if (frames > 0) result.cpu_ms_per_frame = 1e3 * (now.cpu - begin.cpu) / count;
  for (std::size_t i = 0; i < stage_count; ++i) {
    result.stages.push_back({names[i], stages[i].percentile(0.5), stages[i].percentile(0.99)});
  }
  return result;
}

void RunStats::Stretch::restart(const RunMoment& start) {
  begin = start;
  frames = 0;
  age.clear();
  for (DurationBins& stage : stages) stage.clear();
  stage_count = 0;
}

std::string text_of(const RunFigures& figures) {
  std::string text = fmt::format(
      "{:.1f} frames/s   age {:.0f} ms (p99 {:.0f})   {} dropped, {} in texts only   "
      "CPU {:.1f} ms a frame   p50 (p99) ms:",
      figures.frames_per_second, figures.age_p50_ms, figures.age_p99_ms, figures.dropped,
      figures.left_out, figures.cpu_ms_per_frame);
  for (const RunFigures::Stage& stage : figures.stages) {
    text += fmt::format(" {} {:.1f} ({:.1f})", stage.name, stage.p50_ms, stage.p99_ms);
  }
  return text;
}

}  // namespace palpable
