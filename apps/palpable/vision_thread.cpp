#include "apps/palpable/vision_thread.h"

#include <optional>
#include <utility>

namespace palpable::app {
namespace {
constexpr std::size_t kInFlight = 3;  // one being seen, one waiting, one being answered
}

VisionThread::VisionThread(FrameSource& source, Session& session, int frames)
    : ready_(1), free_(kInFlight) {
  for (std::size_t i = 0; i < kInFlight; ++i) free_.push(std::make_unique<FrameInFlight>());
  thread_ = std::thread([this, &source, &session, frames] { run(source, session, frames); });
}

VisionThread::~VisionThread() {
  ready_.close();
  free_.close();
  thread_.join();
}

void VisionThread::run(FrameSource& source, Session& session, int frames) {
  try {
    for (int seen = 0; frames < 0 || seen < frames;) {
      std::optional<std::unique_ptr<FrameInFlight>> item = free_.pop();
      if (!item) break;
      FrameInFlight& flight = **item;
      FrameStatus status = FrameStatus::kUnreadable;
      flight.times.clear();
      {
        const StageTimer timer(flight.times, "read");
        while (status == FrameStatus::kUnreadable) status = source.next(flight.frame);
      }
      if (status == FrameStatus::kEnd) break;
      flight.times.add(session.see(flight.frame, flight.seen));
      ++seen;
      if (!ready_.push(std::move(*item))) break;
    }
  } catch (...) { trouble_ = std::current_exception(); }
  ready_.close();
}

std::unique_ptr<FrameInFlight> VisionThread::next() {
  std::optional<std::unique_ptr<FrameInFlight>> item = ready_.pop();
  if (item) return std::move(*item);
  if (trouble_) std::rethrow_exception(trouble_);
  return nullptr;
}

void VisionThread::recycle(std::unique_ptr<FrameInFlight> frame) { free_.push(std::move(frame)); }

}  // namespace palpable::app
