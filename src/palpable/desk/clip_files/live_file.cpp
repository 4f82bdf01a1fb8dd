#include "palpable/desk/clip_files/live_file.h"

#include "palpable/common/base/json.h"
#include "palpable/desk/clip_files/json_lines.h"
#include "palpable/desk/clip_files/text_file.h"

#include <algorithm>

namespace palpable {
namespace {

Json bodies_of(const std::vector<LiveSummary::Body>& bodies) {
  Json list = Json::array();
  for (const LiveSummary::Body& body : bodies) {
    Json entry{{"name", body.name},       {"body", body.file},
               {"contact", body.contact}, {"takes_reactions", body.takes_reactions},
               {"scale", body.scale},     {"camera_from_body", row_major(body.camera_from_body)}};
    if (body.friction > 0) entry["friction"] = body.friction;
    list.push_back(entry);
  }
  return list;
}

Json tracking_of(const std::optional<LiveSummary::Tracking>& tracking) {
  if (!tracking) return nullptr;
  return {{"frames_moving", tracking->frames_moving},
          {"frames_lost", tracking->frames_lost},
          {"relocalizations", tracking->times_found_again},
          {"loops_closed", tracking->loops_closed},
          {"keyframes", tracking->keyframes},
          {"landmarks", tracking->landmarks},
          {"new_worlds", tracking->new_worlds}};
}

Json map_of(const std::optional<LiveSummary::Map>& map) {
  if (!map) return nullptr;
  return {{"blocks", map->blocks},
          {"blocks_refused", map->refused},
          {"free_space_blocks_refused", map->free_space_refused}};
}

Json depth_json(const LiveSummary::Depth& depth) {
  const bool any = depth.median > 0;
  return {{"median_density", depth.median_density},
          {"median_measured", depth.measured},
          {"median_kept", depth.kept},
          {"median_written", depth.written ? Json(*depth.written) : Json()},
          {"median_m", any ? Json(depth.median) : Json()},
          {"range_m", any ? Json::array({depth.low, depth.high}) : Json()},
          {"unit_m", depth.unit > 0 ? Json(depth.unit) : Json()},
          {"unit_assumed", depth.unit_assumed},
          {"frames_sparse_depth", depth.frames_few_depths},
          {"frames_rows_misaligned", depth.frames_rows_off},
          {"row_misalignment_px", depth.rows_off_px}};
}

Json troubles_of(const LiveSummary::Troubles& troubles) {
  return {{"back_in_time", troubles.back_in_time},
          {"dropped", troubles.dropped},
          {"stalls", troubles.stalls},
          {"losses", troubles.losses},
          {"reports", troubles.reports}};
}

Json named(const std::vector<std::pair<std::string, double>>& values) {
  Json object = Json::object();
  for (const auto& [name, value] : values) object[name] = value;
  return object;
}

Json stats_of(const LiveSummary::Stats& stats) {
  return {{"frames_per_s", stats.frames_per_second},
          {"age_p50_ms", stats.age_p50_ms},
          {"age_p99_ms", stats.age_p99_ms},
          {"cpu_ms_per_frame", stats.cpu_ms_per_frame},
          {"stage_p50_ms", named(stats.stage_p50_ms)},
          {"stage_p99_ms", named(stats.stage_p99_ms)}};
}

// Values of another type count as unknown: no score depends on them.
RunSpeed speed_of(JsonFields& live) {
  constexpr auto kIgnored = JsonFields::Invalid::kIgnored;
  RunSpeed speed;
  live.object_if_there("stats", [&](JsonFields& stats) {
    stats.number("frames_per_s", speed.frames_per_second, 0, kIgnored);
    stats.number("cpu_ms_per_frame", speed.cpu_ms_per_frame, 0, kIgnored);
    stats.number("age_p50_ms", speed.age_p50_ms, 0, kIgnored);
    stats.number("age_p99_ms", speed.age_p99_ms, 0, kIgnored);
  });
  if (!speed.frames_per_second) {  // written before there were "stats"
    std::optional<double> frames, wall;
    live.number("frames", frames, 0, kIgnored);
    live.number("wall_s", wall, 0, kIgnored);
    if (frames && wall && *wall > 0) speed.frames_per_second = *frames / *wall;
  }
  live.number("ringing_j", speed.ringing, 0, kIgnored);
  live.object_if_there("source_troubles", [&](JsonFields& troubles) {
    std::optional<double> dropped;
    troubles.number("dropped", dropped, 0, kIgnored);
    if (dropped && *dropped >= 0 && *dropped < 1e9) speed.dropped = static_cast<int>(*dropped);
  });
  return speed;
}

}  // namespace

Json json_of(const LiveSummary& summary) {
  Json live;
  if (summary.scene.empty()) {
    const LiveSummary::Body& body = summary.bodies.front();
    live["body"] = body.file;
    live["source"] = summary.source;
    live["contact"] = body.contact;
    live["view"] = summary.view;
    live["press_static"] = summary.press_static;
    live["scale"] = body.scale;
    if (body.friction > 0) live["friction"] = body.friction;
    live["camera_from_body"] = row_major(body.camera_from_body);
  } else {
    live["scene"] = summary.scene;
    live["bodies"] = bodies_of(summary.bodies);
    live["source"] = summary.source;
    live["view"] = summary.view;
    live["press_static"] = summary.press_static;
  }
  live["color_from_depth"] =
      summary.color_from_depth ? Json(row_major(*summary.color_from_depth)) : Json();
  live["tracking"] = tracking_of(summary.tracking);
  live["map"] = map_of(summary.map);
  live["depth"] = depth_json(summary.depth);
  live["frames"] = summary.processed.size();
  live["frames_unreadable"] = summary.unreadable;
  live["source_troubles"] = troubles_of(summary.source_troubles);
  live["frames_touching"] = summary.frames_touching;
  live["first_touch_frame"] = summary.first_touch_frame;
  live["deepest_press_m"] = summary.deepest_press;
  if (!summary.scene.empty()) {
    live["frames_bodies_touching"] = summary.frames_between_bodies;
    live["deepest_interpenetration_m"] = summary.deepest_between;
    live["force_imbalance_n"] = summary.imbalance;
  }
  const bool rubs = std::any_of(summary.bodies.begin(), summary.bodies.end(),
                                [](const LiveSummary::Body& body) { return body.friction > 0; });
  if (rubs || summary.friction_residual > 0) {
    live["friction_residual_m"] = summary.friction_residual;
  }
  if (summary.ringing > 0) live["ringing_j"] = summary.ringing;
  live["frames_step_limited"] = summary.frames_step_limited;
  live["frames_contacts_dropped"] = summary.frames_contacts_dropped;
  live["site_changes"] = summary.site_changes;
  live["video_codec"] = summary.video_codec;
  live["pictures"] = summary.pictures;
  live["frames_left_out"] = summary.left_out;
  live["lines_left_out"] = summary.lines_left_out;
  live["color_scale_pa"] = summary.color_scale;
  live["wall_s"] = summary.wall;
  live["states"] = nullptr;
  if (const auto& states = summary.states) {
    live["states"] = {{"hash", states->hash}, {"frames", states->frames}};
  }
  live["stats"] = stats_of(summary.stats);
  for (const auto& [stage, ms] : summary.median_ms) live["median_ms"][stage] = ms;
  live["processed"] = summary.processed;
  return live;
}

void write_live_summary(const std::filesystem::path& path, const LiveSummary& summary) {
  TextFile file(path);
  // File names need not be UTF-8, but JSON must be: other bytes are replaced.
  file.write(json_of(summary).dump(2) + "\n");
  file.close();
}

LiveFile read_live_file(const std::filesystem::path& path) {
  LiveFile file;
  read_object_file(path, [&](JsonFields& live) {
    if (live.has("camera_from_body")) {
      live.rigid("camera_from_body", file.camera_from_body.emplace());
    }
    // null if colour and depth share one view
    if (live.has("color_from_depth") && !live.is_null("color_from_depth")) {
      live.rigid("color_from_depth", file.color_from_depth.emplace());
    }
    if (live.has("processed")) file.processed = live.frames("processed");
    file.speed = speed_of(live);
  });
  return file;
}

}  // namespace palpable
