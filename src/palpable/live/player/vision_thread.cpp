#include "palpable/live/player/vision_thread.h"

#include "palpable/live/sources/wall_clock.h"

#include <iterator>
#include <utility>

namespace palpable {
namespace {
constexpr std::size_t kInFlight = 3;  // one being evaluated, one waiting, one being processed

// s. A frame that seems older, or taken in the future, has a time stamp of another clock.
constexpr double kOldest = 10;

// The time at which the source's latest frame was taken, if the source states a
// plausible one; else now.
double taken_by(const FrameSource& source) {
  const double now = system_clock().now();
  const double taken = source.taken().value_or(now);
  return taken <= now && now - taken < kOldest ? taken : now;
}

}  // namespace

VisionThread::VisionThread(FrameSource& source, DepthCamera& camera, int frames)
    : ready_(1), free_(kInFlight) {
  for (std::size_t i = 0; i < kInFlight; ++i) free_.push(std::make_unique<FrameInFlight>());
  thread_ = std::thread([this, &source, &camera, frames] { run(source, camera, frames); });
}

VisionThread::~VisionThread() {
  ready_.close();
  free_.close();
  thread_.join();
}

void VisionThread::run(FrameSource& source, DepthCamera& camera, int frames) {
  try {
    SourceGuard guard(source);
    for (int seen = 0; frames < 0 || seen < frames;) {
      std::optional<std::unique_ptr<FrameInFlight>> item = free_.pop();
      if (!item) break;
      FrameInFlight& flight = **item;
      FrameStatus status = FrameStatus::kUnreadable;
      StageTimes& times = flight.scene.times;
      times.clear();
      {
        const StageTimer timer(times, "read");
        while (status != FrameStatus::kFrame && status != FrameStatus::kEnd && !ready_.closed()) {
          status = guard.next(flight.frame);
          copy_reports(guard);
        }
      }
      if (status != FrameStatus::kFrame) break;
      flight.taken = taken_by(source);
      camera.see(flight.frame, flight.scene.seen);
      times.add(camera.last_times());
      ++seen;
      if (!ready_.push(std::move(*item))) break;
    }
  } catch (...) { trouble_ = std::current_exception(); }
  ready_.close();
}

std::unique_ptr<FrameInFlight> VisionThread::frame_or_null(
    std::optional<std::unique_ptr<FrameInFlight>> item) {
  if (item) return std::move(*item);
  static_cast<void>(ended());
  return nullptr;
}

bool VisionThread::ended() {
  if (!ready_.drained()) return false;
  if (trouble_) std::rethrow_exception(trouble_);
  return true;
}

std::unique_ptr<FrameInFlight> VisionThread::next() { return frame_or_null(ready_.pop()); }

std::unique_ptr<FrameInFlight> VisionThread::next_within(double seconds) {
  return frame_or_null(ready_.pop_within(std::chrono::duration<double>(seconds)));
}

void VisionThread::copy_reports(SourceGuard& guard) {
  std::vector<std::string> reports = guard.take_reports();
  const std::lock_guard lock(reports_mutex_);
  reports_.troubles = guard.troubles();
  reports_.last_trouble = guard.last_trouble();
  reports_.lines.insert(reports_.lines.end(), std::make_move_iterator(reports.begin()),
                        std::make_move_iterator(reports.end()));
}

SourceReports VisionThread::take_reports() {
  const std::lock_guard lock(reports_mutex_);
  return {std::exchange(reports_.lines, {}), reports_.troubles, reports_.last_trouble};
}

void VisionThread::recycle(std::unique_ptr<FrameInFlight> frame) { free_.push(std::move(frame)); }

}  // namespace palpable
