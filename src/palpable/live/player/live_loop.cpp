#include "palpable/live/player/live_loop.h"

#include "palpable/common/base/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <exception>
#include <optional>
#include <utility>

namespace palpable {
namespace {

int total_of(const FrameSource& source, int frames) {
  const int there = source.frame_count();
  if (frames <= 0) return there;
  return there > 0 ? std::min(there, frames) : frames;
}

SourceTroubles sum_of(SourceTroubles a, const SourceTroubles& b) {
  a.unreadable += b.unreadable;
  a.back_in_time += b.back_in_time;
  a.dropped += b.dropped;
  a.stalls += b.stalls;
  a.losses += b.losses;
  return a;
}

}  // namespace

LiveLoop::LiveLoop(LiveRun& run, int frames, std::function<void(const std::string& line)> report)
    : run_(run),
      total_(total_of(*run.source, frames)),
      report_(std::move(report)),
      frames_(frames) {
  counts_.depth =
      DepthSurvey(run.images.string(), run.source->format(), run.loop.camera.rectified());
  begin_seeing();
}

void LiveLoop::begin_seeing() {
  const int answered = static_cast<int>(counts_.processed.size());
  const int left = frames_ < 0 ? frames_ : std::max(frames_ - answered, 0);
  vision_.emplace(*run_.source, run_.loop.camera, left);
}

void LiveLoop::begin_anew(const std::function<void(LiveRun&)>& change) {
  counts();
  troubles_before_ = counts_.troubles;
  flight_.reset();
  vision_.reset();
  std::exception_ptr trouble;
  try {
    change(run_);
  } catch (...) { trouble = std::current_exception(); }
  begin_seeing();
  if (trouble) std::rethrow_exception(trouble);
}

Scene* LiveLoop::next() {
  recycle();
  return ended() ? nullptr : process(vision_->next());
}

Scene* LiveLoop::next_within(double seconds) {
  recycle();
  return ended() ? nullptr : process(vision_->next_within(seconds));
}

bool LiveLoop::ended() {
  const bool all_answered = total_ > 0 && static_cast<int>(counts_.processed.size()) >= total_;
  return all_answered || vision_->ended();
}

const LiveCounts& LiveLoop::counts() {
  SourceReports reports = vision_->take_reports();
  for (std::string& line : reports.lines) report(std::move(line));
  counts_.troubles = sum_of(troubles_before_, reports.troubles);
  if (!reports.last_trouble.empty()) counts_.last_trouble = std::move(reports.last_trouble);
  return counts_;
}

Scene* LiveLoop::process(std::unique_ptr<FrameInFlight> flight) {
  counts();
  if (!flight) return nullptr;
  flight_ = std::move(flight);
  Scene& scene = flight_->scene;
  if (scene.seen.misfit) {
    throw Error(fmt::format("{}: {}", run_.images.string(), scene.seen.misfit->message()));
  }
  run_.loop.session.respond(scene);
  if (Refiner* refiner = run_.loop.session.refiner()) {
    // The reason why refinement has ended, if it has.
    if (std::optional<std::string> trouble = refiner->take_trouble()) report(std::move(*trouble));
  }
  counts_.add(scene);
  report_depth();
  return &scene;
}

void LiveLoop::finish() {
  counts_.depth.finish();
  report_depth();
}

void LiveLoop::report_depth() {
  for (std::string& line : counts_.depth.take_warnings()) report(std::move(line));
}

void LiveLoop::report(std::string line) {
  if (report_) report_(line);
  counts_.reports.push_back(std::move(line));
}

void LiveLoop::recycle() {
  if (flight_) vision_->recycle(std::move(flight_));
}

}  // namespace palpable
