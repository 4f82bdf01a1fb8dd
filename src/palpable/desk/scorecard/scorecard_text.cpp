#include "palpable/desk/scorecard/scorecard.h"

#include <fmt/core.h>

namespace palpable {
namespace {

/// A line with a score; "-" when there is none.
std::string line(const char* what, const std::optional<double>& score, const char* unit,
                 int digits) {
  if (!score) return fmt::format("{:<44}-\n", what);
  return fmt::format("{:<44}{:.{}f}{}\n", what, *score, digits, unit);
}

std::string count(const char* what, const std::optional<int>& score, const char* unit = "") {
  if (!score) return fmt::format("{:<44}-\n", what);
  return fmt::format("{:<44}{}{}\n", what, *score, unit);
}

/// A line with the median and the 90th percentile.
std::string spread(const char* what, const std::optional<MedianAndP90>& score, const char* unit,
                   int digits) {
  if (!score) return fmt::format("{:<44}-\n", what);
  return fmt::format("{:<44}{:.{}f}{} ({:.{}f}{} in 9 of 10)\n", what, score->median, digits, unit,
                     score->p90, digits, unit);
}

std::string deformed_lines(const DeformedScores& deformed) {
  if (!deformed.deformed_frames) return {};
  std::string text = count("frames with a full-order solution, deep", deformed.deformed_frames);
  text += count("  and shallow", deformed.deformed_frames_shallow);
  text += count("  whose touch no camera sees: not judged", deformed.deformed_frames_unseen);
  text += spread("displacement, relative error", deformed.displacement_error, "", 3);
  text += spread("  at the worst vertex", deformed.displacement_error_mm, " mm", 2);
  text += spread("  in shallow touches", deformed.displacement_error_mm_shallow, " mm", 2);
  text +=
      spread("  where no camera sees the touch", deformed.displacement_error_mm_unseen, " mm", 2);
  text += spread("stress, error of the maximum", deformed.von_mises_error, "", 3);
  text += spread("force, relative error", deformed.force_error, "", 3);
  std::optional<double> p50;
  std::optional<double> p99;
  if (deformed.overpress_mm) {
    p50 = deformed.overpress_mm->p50;
    p99 = deformed.overpress_mm->p99;
  }
  text += line("pressed too far, median", p50, " mm", 2);
  text += line("pressed too far, 99 of 100", p99, " mm", 2);
  return text;
}

std::string press_lines(const PressScores& press, const SurfaceScores& surface,
                        const DeformedScores& deformed) {
  std::string text = count("frames with a true touch", press.frames_touching);
  text +=
      count("first touch felt after the true one by", press.first_touch_delay_frames, " frames");
  text += line("felt touches that are true", press.touch_precision, "", 3);
  text += line("true touches that are felt", press.touch_recall, "", 3);
  text += line("  at the right site", press.touch_site, "", 3);
  text += line("true touches of 3 mm and seen that are felt", press.touch_recall_3mm, "", 3);
  text += line("felt touches with nothing within 5 mm", press.touch_false_5mm, "", 3);
  text += count("frames too deep to be scored", surface.frames_too_deep);
  text += count("frames whose touch no camera sees", surface.frames_unseen);
  text += line("penetration left, median", surface.penetration_median_mm, " mm", 2);
  text += line("penetration left, 99 of 100", surface.penetration_p99_mm, " mm", 2);
  text += line("  median where no camera sees the touch", surface.penetration_median_mm_unseen,
               " mm", 2);
  text += line("largest unexplained jump of the surface", surface.largest_pop_mm, " mm", 2);
  text += count("  jumps of more than 4 mm", surface.pops_4mm);
  text += deformed_lines(deformed);
  return text;
}

std::string depth_table(const ImageScores& images) {
  if (images.depth_frames == 0) return {};
  std::string text = "depth at (m)    median error   within 1 %   (the paper's camera: 1 to 9 %)\n";
  for (std::size_t k = 0; k < kDepthDistances.size(); ++k) {
    const DepthAtDistance& at = images.depth.at[k];
    if (!at.median_error || !at.within_1pct) continue;
    text += fmt::format("{:>12}{:>15.2f} %{:>11.1f} %\n", fmt::format("{}", kDepthDistances[k]),
                        100 * *at.median_error, 100 * *at.within_1pct);
  }
  return text;
}

// A summary for people: the errors of shape and force, over the frames that are scored.
std::string in_short(const DeformedScores& deformed, const std::string& body) {
  const auto& shape = deformed.displacement_error;
  const auto& force = deformed.force_error;
  if (!deformed.deformed_frames || !shape) return {};
  std::string text = fmt::format(
      "in short: {}response computed from the camera's pictures, against full finite elements "
      "under "
      "the true hand ({} frames): shape off by {:.0f} % in the median ({:.0f} % in 9 of 10)",
      body, *deformed.deformed_frames, 100 * shape->median, 100 * shape->p90);
  if (force) {
    text += fmt::format(", force by {:.0f} % ({:.0f} %)", 100 * force->median, 100 * force->p90);
  }
  return text + "\n";
}

}  // namespace

std::string text_of(const Scorecard& scores) {
  const ImageScores& images = scores.images;
  std::string text = count("frames", scores.frames);
  text += count("  that the result processed", scores.frames_processed);
  text += count("frames whose depth is scored", images.depth_frames);
  text += depth_table(images);
  text += line("near hand within 1 %", images.depth.hand_within_1pct, "", 3);
  text += line("too close, but called far", images.depth.too_close_called_far, "", 4);
  text += line("camera path, absolute error", scores.path.ate_mm, " mm", 2);
  text += line("  share of the path that was found", scores.path.trajectory_share, "", 3);
  text += line("camera path, error over 1 s", scores.path.rpe_mm, " mm", 2);
  text += line("what moves, intersection over union", images.moving_iou, "", 3);
  text += line("what moves, found", images.moving_recall, "", 3);
  text += line("called moving and is not, of all pixels", images.moving_false, "", 5);
  if (scores.bodies.empty()) { text += press_lines(scores.press, scores.surface, scores.deformed); }
  for (const BodyScores& body : scores.bodies) {
    text += fmt::format("{}\n", body.name) + press_lines(body.press, body.surface, body.deformed);
    text += spread("body drawn off its place by", body.surface.placement_error_mm, " mm", 2);
  }
  if (scores.reduction_error) {
    text += fmt::format("{:<44}{:.2e}\n", "error of the reduced model, pooled",
                        *scores.reduction_error);
  }
  text += count("frames whose occlusion is scored", images.occlusion_frames);
  text += line("visible body, intersection over union", images.occlusion_iou, "", 3);
  text += line("  where a hand hides part of it", images.occlusion_iou_where_hidden, "", 3);
  text += line("  in the worst frame", images.occlusion_iou_worst_frame, "", 3);
  text += line("border between body and hand is off by", images.edge_error_px, " px", 1);
  text += line("  where a hand crosses the outline", images.edge_error_crossing_px, " px", 1);
  text += line("flicker", images.flicker, "", 4);
  text += spread("body drawn off its place by", scores.surface.placement_error_mm, " mm", 2);
  text += line("jitter of the body in the world", scores.jitter_mm, " mm", 2);
  text += line("rows out of line, at worst", scores.row_error_px, " px", 2);
  if (scores.bodies.empty()) text += in_short(scores.deformed, "");
  for (const BodyScores& body : scores.bodies) {
    text += in_short(body.deformed, body.name + ": ");
  }
  return text;
}

}  // namespace palpable
