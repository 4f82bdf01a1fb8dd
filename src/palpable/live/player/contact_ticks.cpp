#include "palpable/live/player/contact_ticks.h"

#include "palpable/common/base/contract.h"
#include "palpable/live/sources/wall_clock.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace palpable {
namespace {

// s, assumed time until the second frame of a camera.
constexpr double kUsualInterval = 1.0 / 30;
constexpr int kLate = 2;  // intervals during which ticks continue without a new frame

double farthest(const Eigen::Matrix3Xf& a, const Eigen::Matrix3Xf& b) {
  return a.cols() == b.cols() && a.cols() > 0
             ? std::sqrt(static_cast<double>((a - b).colwise().squaredNorm().maxCoeff()))
             : 0;
}

}  // namespace

ContactTicks::ContactTicks(const Session& session, const Settings& settings,
                           std::function<void(const ContactTick&)> report)
    : settings_(settings),
      report_(std::move(report)),
      between_(session),
      skin_(3, session.body().model().surface.vertex_count()),
      skin_of_frame_(session.body().model().surface.vertices.cast<float>()),
      skin_at_end_(skin_) {
  PALPABLE_EXPECT(settings.rate > 0 && std::isfinite(settings.rate), "a rate is above 0");
  thread_ = std::thread([this] { run(); });
}

ContactTicks::~ContactTicks() {
  if (thread_.joinable()) static_cast<void>(finish());
}

void ContactTicks::end_frame() {
  std::unique_lock lock(mutex_);
  if (settings_.when_due) {
    cuts_ = true;
    changed_.notify_all();
  }
  changed_.wait(lock, [this] { return !is_waiting_ && !is_busy_; });
  cuts_ = false;
}

void ContactTicks::begin_frame(const Session& session, const Scene& scene) {
  taken_.take(session, scene);
  const std::lock_guard lock(mutex_);
  std::swap(waiting_, taken_);
  is_waiting_ = true;
  changed_.notify_all();
}

ContactTickFigures ContactTicks::finish() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
    changed_.notify_all();
  }
  if (thread_.joinable()) thread_.join();
  ContactTickFigures figures = figures_;
  figures.p50_ms = times_.percentile(0.5);
  figures.p99_ms = times_.percentile(0.99);
  if (figures.frames > 0) {
    figures.off = off_ / figures.frames;
    figures.off_held = off_held_ / figures.frames;
  }
  return figures;
}

void ContactTicks::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return is_waiting_ || ends_; });
    if (!is_waiting_) return;
    std::swap(frame_, waiting_);
    is_waiting_ = false;
    is_busy_ = true;
    lock.unlock();
    run_ticks();
    lock.lock();
    is_busy_ = false;
    changed_.notify_all();
  }
}

// Waits until a tick is due. Returns false when the next frame has come or the run ends.
bool ContactTicks::is_due(double ahead, double begin) {
  if (!settings_.when_due) return true;
  std::unique_lock lock(mutex_);
  const std::chrono::duration<double> wait(begin + ahead - system_clock().now());
  changed_.wait_for(lock, wait, [this] { return cuts_ || ends_; });
  return !cuts_ && !ends_;
}

void ContactTicks::run_ticks() {
  const double begin = system_clock().now();
  compare(frame_);
  between_.begin(frame_);
  between_.place(skin_of_frame_);
  const double interval = between_.interval() > 0 ? between_.interval() : kUsualInterval;
  const int of_frame = std::max(1, static_cast<int>(std::lround(settings_.rate * interval)));
  const int last = settings_.when_due ? kLate * of_frame : of_frame;
  reached_end_ = false;
  for (int tick = 1; tick <= last; ++tick) {
    const double ahead = tick / settings_.rate;
    if (!is_due(ahead, begin)) {
      figures_.left_out += static_cast<std::uint64_t>(std::max(of_frame - tick + 1, 0));
      return;
    }
    const auto start = std::chrono::steady_clock::now();
    between_.advance(ahead);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    if (!between_.touches().empty()) times_.add(took.count());
    ++figures_.ticks;
    if (report_) {
      report_({frame_.number, tick, ahead, frame_.time + ahead, &between_.touches()});
    }
    if (tick == of_frame) {
      between_.place(skin_at_end_);
      reached_end_ = true;
    }
  }
}

// Measures the error of the last ticks; called with the next frame before between_ is updated.
void ContactTicks::compare(const SolvedFrame& next) {
  if (!reached_end_ || between_.state().forces.empty() || next.state.forces.empty()) return;
  between_.place(next.state, skin_);
  ++figures_.frames;
  off_ += farthest(skin_, skin_at_end_);
  off_held_ += farthest(skin_, skin_of_frame_);
}

std::string text_of(const ContactTickFigures& figures) {
  std::string text =
      fmt::format("between frames: {} ticks, {} left out", figures.ticks, figures.left_out);
  if (figures.frames == 0) return text;
  return text + fmt::format(
                    "; {:.2f} ms each while touched (p99 {:.2f}); the next of {} touched frames "
                    "found the skin {:.2f} mm from there, {:.2f} mm from where the frame before "
                    "had it (its farthest vertex, on average)",
                    figures.p50_ms, figures.p99_ms, figures.frames, 1e3 * figures.off,
                    1e3 * figures.off_held);
}

}  // namespace palpable
