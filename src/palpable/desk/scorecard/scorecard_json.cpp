#include "palpable/common/base/json.h"
#include "palpable/desk/scorecard/scorecard.h"

#include <fmt/core.h>

namespace palpable {
namespace {

template <class T>
Json or_null(const std::optional<T>& value) {
  return value;
}

Json both(const char* first, double one, const char* second, double other) {
  return {{first, one}, {second, other}};
}

Json or_null(const std::optional<MedianAndP90>& value) {
  return value ? both("median", value->median, "p90", value->p90) : Json(nullptr);
}

Json or_null(const std::optional<P50AndP99>& value) {
  return value ? both("p50", value->p50, "p99", value->p99) : Json(nullptr);
}

Json by_frame(const DeformedScores& deformed) {
  if (!deformed.deformed_frames) return nullptr;
  Json frames = Json::array();
  for (const DeformedFrame& frame : deformed.frames) {
    frames.push_back({{"frame", frame.frame},
                      {"displacement_error", or_null(frame.displacement_error)},
                      {"displacement_error_mm", or_null(frame.displacement_error_mm)},
                      {"von_mises_error", or_null(frame.von_mises_error)},
                      {"force_error", or_null(frame.force_error)}});
  }
  return frames;
}

// @param scores  a Scorecard, or BodyScores
template <class Scores>
void add_press(const Scores& scores, Json& json) {
  const PressScores& press = scores.press;
  json["frames_touching"] = or_null(press.frames_touching);
  json["touch_precision"] = or_null(press.touch_precision);
  json["touch_recall"] = or_null(press.touch_recall);
  json["touch_site"] = or_null(press.touch_site);
  json["first_touch_delay_frames"] = or_null(press.first_touch_delay_frames);
  json["touch_recall_3mm"] = or_null(press.touch_recall_3mm);
  json["touch_false_5mm"] = or_null(press.touch_false_5mm);
  const SurfaceScores& surface = scores.surface;
  json["frames_too_deep"] = or_null(surface.frames_too_deep);
  json["frames_unseen"] = or_null(surface.frames_unseen);
  json["penetration_median_mm"] = or_null(surface.penetration_median_mm);
  json["penetration_p99_mm"] = or_null(surface.penetration_p99_mm);
  json["penetration_median_mm_unseen"] = or_null(surface.penetration_median_mm_unseen);
  json["largest_pop_mm"] = or_null(surface.largest_pop_mm);
  json["largest_pop_frame"] = or_null(surface.largest_pop_frame);
  json["pops_4mm"] = or_null(surface.pops_4mm);
  const DeformedScores& deformed = scores.deformed;
  json["deformed_frames"] = or_null(deformed.deformed_frames);
  json["deformed_frames_shallow"] = or_null(deformed.deformed_frames_shallow);
  json["deformed_frames_unseen"] = or_null(deformed.deformed_frames_unseen);
  json["displacement_error"] = or_null(deformed.displacement_error);
  json["displacement_error_mm"] = or_null(deformed.displacement_error_mm);
  json["displacement_error_mm_shallow"] = or_null(deformed.displacement_error_mm_shallow);
  json["displacement_error_mm_unseen"] = or_null(deformed.displacement_error_mm_unseen);
  json["von_mises_error"] = or_null(deformed.von_mises_error);
  json["force_error"] = or_null(deformed.force_error);
  json["overpress_mm"] = or_null(deformed.overpress_mm);
  json["deformed_by_frame"] = by_frame(deformed);
}

void add_depth(const ImageScores& images, Json& json) {
  const bool any = images.depth_frames > 0;
  const DepthScore& depth = images.depth;
  json["depth_frames"] = images.depth_frames;
  for (const char* key : {"depth_median", "depth_within_1pct", "depth_density"}) {
    json[key] = nullptr;
  }
  for (std::size_t k = 0; any && k < kDepthDistances.size(); ++k) {
    const std::string distance = fmt::format("{}", kDepthDistances[k]);
    json["depth_median"][distance] = or_null(depth.at[k].median_error);
    json["depth_within_1pct"][distance] = or_null(depth.at[k].within_1pct);
    json["depth_density"][distance] = or_null(depth.at[k].density);
  }
  json["hand_within_1pct"] = or_null(depth.hand_within_1pct);
  json["hand_near_frames"] = any ? Json(depth.near_frames) : Json(nullptr);
  json["too_close_called_far"] = or_null(depth.too_close_called_far);
}

}  // namespace

std::string json_of(const Scorecard& scores) {
  Json json;
  json["frames"] = scores.frames;
  json["frames_processed"] = scores.frames_processed;
  add_depth(scores.images, json);
  json["moving_iou"] = or_null(scores.images.moving_iou);
  json["moving_recall"] = or_null(scores.images.moving_recall);
  json["moving_false"] = or_null(scores.images.moving_false);
  json["occlusion_frames"] = scores.images.occlusion_frames;
  json["occlusion_iou"] = or_null(scores.images.occlusion_iou);
  json["occlusion_iou_where_hidden"] = or_null(scores.images.occlusion_iou_where_hidden);
  json["occlusion_iou_worst_frame"] = or_null(scores.images.occlusion_iou_worst_frame);
  json["edge_error_px"] = or_null(scores.images.edge_error_px);
  json["crossing_frames"] = scores.images.crossing_frames;
  json["edge_error_crossing_px"] = or_null(scores.images.edge_error_crossing_px);
  json["flicker"] = or_null(scores.images.flicker);
  json["ate_mm"] = or_null(scores.path.ate_mm);
  json["rpe_mm"] = or_null(scores.path.rpe_mm);
  json["rpe_deg"] = or_null(scores.path.rpe_deg);
  json["trajectory_share"] = or_null(scores.path.trajectory_share);
  add_press(scores, json);
  for (const BodyScores& body : scores.bodies) {
    Json& of_body = json["bodies"][body.name];
    add_press(body, of_body);
    of_body["placement_error_mm"] = or_null(body.surface.placement_error_mm);
  }
  json["placement_error_mm"] = or_null(scores.surface.placement_error_mm);
  json["jitter_mm"] = or_null(scores.jitter_mm);
  json["row_error_px"] = or_null(scores.row_error_px);
  if (scores.reduction_error) {
    json["reduction_error"] = *scores.reduction_error;
    json["reduction_error_worst"] = or_null(scores.reduction_error_worst);
  }
  return json.dump(2);
}

}  // namespace palpable
