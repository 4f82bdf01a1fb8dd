#include "palpable/desk/clip_files/live_file.h"

#include "palpable/common/base/bounded_text.h"
#include "palpable/common/base/error.h"
#include "palpable/desk/clip_files/json_lines.h"
#include "palpable/desk/clip_files/text_file.h"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace palpable {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

ordered_json rows_of(const Rigid3& pose) {
  ordered_json numbers = ordered_json::array();
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) numbers.push_back(pose.matrix()(row, column));
  }
  return numbers;
}

ordered_json bodies_of(const std::vector<LiveSummary::Body>& bodies) {
  ordered_json list = ordered_json::array();
  for (const LiveSummary::Body& body : bodies) {
    list.push_back({{"name", body.name},
                    {"body", body.file},
                    {"contact", body.contact},
                    {"takes_reactions", body.takes_reactions},
                    {"scale", body.scale},
                    {"camera_from_body", rows_of(body.camera_from_body)}});
  }
  return list;
}

ordered_json tracking_of(const std::optional<LiveSummary::Tracking>& tracking) {
  if (!tracking) return nullptr;
  return {{"frames_moving", tracking->frames_moving},
          {"frames_lost", tracking->frames_lost},
          {"times_found_again", tracking->times_found_again},
          {"loops_closed", tracking->loops_closed},
          {"keyframes", tracking->keyframes},
          {"landmarks", tracking->landmarks},
          {"new_worlds", tracking->new_worlds}};
}

ordered_json map_of(const std::optional<LiveSummary::Map>& map) {
  if (!map) return nullptr;
  return {{"blocks", map->blocks},
          {"refused", map->refused},
          {"free_space_refused", map->free_space_refused}};
}

ordered_json depth_json(const LiveSummary::Depth& depth) {
  return {{"median_density", depth.median_density},
          {"frames_few_depths", depth.frames_few_depths},
          {"frames_rows_off", depth.frames_rows_off},
          {"rows_off_px", depth.rows_off_px}};
}

ordered_json troubles_of(const LiveSummary::Troubles& troubles) {
  return {{"back_in_time", troubles.back_in_time},
          {"dropped", troubles.dropped},
          {"stalls", troubles.stalls},
          {"losses", troubles.losses},
          {"reports", troubles.reports}};
}

ordered_json named(const std::vector<std::pair<std::string, double>>& values) {
  ordered_json object = ordered_json::object();
  for (const auto& [name, value] : values) object[name] = value;
  return object;
}

ordered_json stats_of(const LiveSummary::Stats& stats) {
  return {{"frames_per_s", stats.frames_per_second},
          {"age_p50_ms", stats.age_p50_ms},
          {"age_p99_ms", stats.age_p99_ms},
          {"cpu_ms_per_frame", stats.cpu_ms_per_frame},
          {"stage_p50_ms", named(stats.stage_p50_ms)},
          {"stage_p99_ms", named(stats.stage_p99_ms)}};
}

template <class T>
ordered_json or_null(const std::optional<T>& value) {
  return value ? ordered_json(*value) : ordered_json(nullptr);
}

LiveFile live_file_of(const json& live) {
  if (!live.is_object()) throw Error("is no JSON object");
  LiveFile file;
  const JsonObject object(live);
  if (object.has("camera_from_body")) file.camera_from_body = object.rigid("camera_from_body");
  // null if colour and depth share one view
  if (live.contains("color_from_depth") && !live.at("color_from_depth").is_null())
    file.color_from_depth = object.rigid("color_from_depth");
  if (!object.has("processed")) return file;
  if (!live.at("processed").is_array()) throw Error("processed is no list of frames");
  file.processed.emplace();
  for (const json& frame : live.at("processed")) file.processed->push_back(frame_number(frame));
  return file;
}

}  // namespace

void write_live_summary(const std::filesystem::path& path, const LiveSummary& summary) {
  ordered_json live;
  if (summary.scene.empty()) {
    const LiveSummary::Body& body = summary.bodies.front();
    live["body"] = body.file;
    live["source"] = summary.source;
    live["contact"] = body.contact;
    live["view"] = summary.view;
    live["press_static"] = summary.press_static;
    live["scale"] = body.scale;
    live["camera_from_body"] = rows_of(body.camera_from_body);
  } else {
    live["scene"] = summary.scene;
    live["bodies"] = bodies_of(summary.bodies);
    live["source"] = summary.source;
    live["view"] = summary.view;
    live["press_static"] = summary.press_static;
  }
  live["color_from_depth"] =
      summary.color_from_depth ? rows_of(*summary.color_from_depth) : ordered_json(nullptr);
  live["tracking"] = tracking_of(summary.tracking);
  live["map"] = map_of(summary.map);
  live["depth"] = depth_json(summary.depth);
  live["frames"] = summary.processed.size();
  live["unreadable"] = summary.unreadable;
  live["source_troubles"] = troubles_of(summary.source_troubles);
  live["frames_touching"] = summary.frames_touching;
  live["first_touch_frame"] = or_null(summary.first_touch_frame);
  live["deepest_press_m"] = summary.deepest_press;
  if (!summary.scene.empty()) {
    live["frames_between_bodies"] = summary.frames_between_bodies;
    live["deepest_between_m"] = summary.deepest_between;
    live["imbalance_n"] = summary.imbalance;
  }
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
  TextFile file(path);
  // File names need not be UTF-8, but JSON must be: other bytes are replaced.
  file.write(live.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n");
  file.close();
}

LiveFile read_live_file(const std::filesystem::path& path) {
  const std::string text = value_or_throw(read_bounded_text(path, Notation::kJson));
  try {
    return live_file_of(json::parse(text));
  } catch (const json::parse_error& error) {
    throw Error(fmt::format("{}: no JSON at character {}", path.string(), error.byte));
  } catch (const json::exception& error) {
    throw Error(fmt::format("{}: {}", path.string(), without_brackets(error.what())));
  } catch (const Error& error) { throw Error(fmt::format("{}: {}", path.string(), error.what())); }
}

}  // namespace palpable
