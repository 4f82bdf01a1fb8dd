#include "palpable/live/live_writer/live_summary.h"

#include "palpable/common/base/order_statistics.h"
#include "palpable/live/view/stress_scale.h"

#include <vector>

namespace palpable {

namespace {

LiveSummary::Stats stats_of(const RunFigures& figures) {
  LiveSummary::Stats stats;
  stats.frames_per_second = figures.frames_per_second;
  stats.age_p50_ms = figures.age_p50_ms;
  stats.age_p99_ms = figures.age_p99_ms;
  stats.cpu_ms_per_frame = figures.cpu_ms_per_frame;
  for (const RunFigures::Stage& stage : figures.stages) {
    stats.stage_p50_ms.emplace_back(stage.name, stage.p50_ms);
    stats.stage_p99_ms.emplace_back(stage.name, stage.p99_ms);
  }
  return stats;
}

}  // namespace

LiveSummary summary_of(const LiveRun& run, const LiveCounts& counts, const RunFigures& figures,
                       const LiveOutput* output) {
  const Session& session = run.loop.session;
  LiveSummary result;
  result.source = run.images.string();
  result.press_static = session.settings().press_static;
  for (int k = 0; k < session.body_count(); ++k) {
    LiveSummary::Body& body = result.bodies.emplace_back();
    body.name = session.body(k).name;
    body.contact = name_of(session.body(k).response.contact());
    body.takes_reactions = session.body(k).response.contact() == ContactKind::kAnywhere;
    body.friction = session.body(k).response.coefficient();
    body.camera_from_body =
        session.body(k).world_from_body;  // the world frame is the first camera frame
  }
  if (const auto& color = run.source->format().color_sensor) {
    result.color_from_depth = color->color_from_depth;
  }
  if (const Tracker* followed = session.slam().tracker()) {
    const TrackerCounts tracker = followed->counts();
    result.tracking = {counts.moving,     counts.lost,       tracker.recognised, tracker.loops,
                       tracker.keyframes, tracker.landmarks, counts.new_worlds};
  }
  if (const SurfaceMap* map = session.slam().map()) {
    result.map = {map->blocks(), map->refused(), session.slam().space()->blocked()};
  }
  const std::vector<double> densities(counts.densities.begin(), counts.densities.end());
  const DepthFigures depth = counts.depth.figures();
  result.depth = {densities.empty() ? 0 : percentile(densities, 0.5),
                  counts.few_depths,
                  counts.rows_off,
                  counts.rows_off_px,
                  depth.measured,
                  depth.kept,
                  depth.median,
                  depth.low,
                  depth.high,
                  depth.unit,
                  depth.unit_assumed};
  result.unreadable = counts.troubles.unreadable;
  result.source_troubles = {counts.troubles.back_in_time, counts.troubles.dropped,
                            counts.troubles.stalls, counts.troubles.losses, counts.reports};
  add_contact(counts, figures, output, result);
  result.color_scale = stress_scale(session);
  return result;
}

void add_contact(const LiveCounts& counts, const RunFigures& figures, const LiveOutput* output,
                 LiveSummary& result) {
  result.frames_touching = counts.touching;
  result.first_touch_frame = counts.first_touch;
  result.deepest_press = counts.deepest;
  result.frames_between_bodies = counts.between_bodies;
  result.deepest_between = counts.between;
  result.imbalance = counts.imbalance;
  result.frames_step_limited = counts.left_to_move;
  result.frames_contacts_dropped = counts.dropped;
  result.friction_residual = counts.friction_residual;
  result.ringing = counts.ringing;
  result.site_changes = counts.site_changes;
  result.stats = stats_of(figures);
  result.processed = counts.processed;
  if (output == nullptr) return;
  result.video_codec = output->codec();
  result.pictures = output->figures();
  const std::vector<double>& written = output->depth_written();
  if (!written.empty()) result.depth.written = percentile(written, 0.5);
  result.left_out = output->left_out();
  result.lines_left_out = output->lines_left_out();
  for (const auto& [stage, values] : output->times()) {
    if (!values.empty()) result.median_ms.emplace_back(stage, percentile(values, 0.5));
  }
}

}  // namespace palpable
