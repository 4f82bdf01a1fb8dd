#include "palpable/live/track/keyframe_work.h"

#include "palpable/common/base/cpu_time.h"
#include "palpable/live/track/tracker.h"

#include <memory>
#include <system_error>
#include <utility>

namespace palpable {
namespace {

constexpr int kLoopCandidates = 2;    // old keyframes with which a new one is compared
constexpr int kLeastRecognised = 20;  // features that must agree

KeyframeWork done(KeyframeWork work) {
  double cpu = 0;
  {
    const CpuTimer timer(cpu);
    if (work.window) adjust(*work.window);
    if (work.graph) work.graph_is_solved = adjust_pose_graph(*work.graph).solved;
    work.features = find_features(work.image, work.camera, work.depth);
    for (const auto& [number, known] : work.candidates) {
      const std::optional<Recognised> seen = recognise(work.features, known, work.camera);
      if (!seen || seen->agreeing < kLeastRecognised) continue;
      if (work.loop && seen->agreeing <= work.loop->new_from_old.agreeing) continue;
      work.loop = Loop{number, work.number, *seen};
    }
  }
  work.cpu_s = cpu;
  return work;
}

}  // namespace

KeyframeWork work_for_newest(const TrackerSettings& settings, const LandmarkMap& map,
                             const GrayImage& image_at_half_size, const DepthImage& depth,
                             std::optional<Loop> closing,
                             const std::optional<DisparityWatch>& watch) {
  KeyframeWork work;
  work.number = map.keyframes.back().number;
  work.image = image_at_half_size;
  work.camera = settings.camera.camera.scaled_down(2);
  work.depth = depth;
  if (closing) {
    work.closing = std::move(closing);
    work.graph = graph_of(settings.camera, map, *work.closing);
  }
  if (work.graph) return work;
  if (settings.adjust && map.keyframes.size() > 1) {
    work.window = window_of(settings.camera, map);
    work.window->watch = watch;
  }
  if (settings.close_loops) {
    for (const int k : loop_candidates(map, kLoopCandidates)) {
      work.candidates.emplace_back(map.keyframes[k].number, map.keyframes[k].features);
    }
  }
  return work;
}

void KeyframeWorker::begin(KeyframeWork work, bool on_thread) {
  const auto shared = std::make_shared<KeyframeWork>(std::move(work));
  const auto work_out = [shared] { return done(std::move(*shared)); };
  pending_ = std::async(std::launch::deferred, work_out);
  deferred_ = true;
  if (!on_thread) return;
  try {
    pending_ = std::async(std::launch::async, work_out);
    deferred_ = false;
  } catch (const std::system_error&) {  // no thread available: finish() does the work
  }
}

KeyframeWork KeyframeWorker::finish() {
  const double before = thread_cpu_seconds();
  KeyframeWork work = pending_->get();
  pending_.reset();
  work.cpu_s_of_caller = deferred_ ? thread_cpu_seconds() - before : 0;
  return work;
}

}  // namespace palpable
