// palpable score: what a run did against the truth of what it saw, whoever made the run.
// docs/benchmark.md has the formats of both folders and the meaning of every score.

#include "apps/common/command_line.h"
#include "apps/common/json.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/score_files.h"
#include "apps/palpable/score_images.h"
#include "apps/palpable/score_surface.h"
#include "palpable/base/error.h"
#include "palpable/reduced/body_file.h"
#include "palpable/score/anchor_score.h"
#include "palpable/score/touch_score.h"

#include <fmt/core.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;
struct Options {
  fs::path truth;
  fs::path result;
  fs::path body;
  bool json = false;
};

void score_trajectories(const TruthFolder& truth, const ResultFolder& result, Json& scores) {
  for (const char* key : {"ate_mm", "rpe_mm", "rpe_deg", "trajectory_share"}) scores[key] = nullptr;
  if (truth.trajectory.empty() || !result.trajectory) return;
  const double half_a_frame = 0.5 / truth.frames_per_second;
  std::vector<StampedPose> asked;
  for (std::size_t f = 0; f < truth.trajectory.size(); ++f)
    if (result.processed[f] != 0) asked.push_back(truth.trajectory[f]);
  const std::vector<PosePair> pairs = match_in_time(asked, *result.trajectory, half_a_frame);
  if (!asked.empty()) {
    scores["trajectory_share"] =
        static_cast<double>(pairs.size()) / static_cast<double>(asked.size());
  }
  if (pairs.size() < 2) return;  // one can be laid on any other
  const TrajectoryScore score = score_trajectory(pairs);
  scores["ate_mm"] = 1e3 * score.ate;
  if (!score.rpe) return;
  scores["rpe_mm"] = 1e3 * *score.rpe;
  scores["rpe_deg"] = *score.rpe_angle * 180 / std::numbers::pi;
}

void score_touching(const TruthFolder& truth, const ResultFolder& result, Json& scores) {
  for (const char* key : {"frames_touching", "touch_precision", "touch_recall", "touch_site",
                          "first_touch_delay_frames"})
    scores[key] = nullptr;
  if (truth.contacts.empty()) return;
  const auto n = static_cast<std::size_t>(truth.frames);
  std::vector<std::uint8_t> is(n, 0);
  std::vector<std::uint8_t> felt(n, 0);
  std::vector<int> true_site(n, -1);
  std::vector<int> felt_site(n, -1);
  for (std::size_t f = 0; f < n; ++f) {
    is[f] = truth.contacts[f].touching ? 1 : 0;
    if (truth.contacts[f].touching) true_site[f] = truth.contacts[f].site;
  }
  if (result.touches) {
    for (const auto& [frame, touch] : *result.touches) {
      if (frame >= truth.frames) {
        throw Error(fmt::format("{}: frame {} is touched, but the truth has {} frames (from 0 on)",
                                (result.folder / "touches.jsonl").string(), frame, truth.frames));
      }
      if (result.processed[static_cast<std::size_t>(frame)] == 0) continue;
      felt[static_cast<std::size_t>(frame)] = 1;
      felt_site[static_cast<std::size_t>(frame)] = touch.site;
    }
  }
  const TouchScore score = score_touches(is, felt);
  scores["frames_touching"] = score.truly_touching;
  if (!result.touches) return;
  scores["touch_precision"] = score.precision;
  scores["touch_recall"] = score.recall;
  scores["touch_site"] = score_sites(true_site, felt_site);
  scores["first_touch_delay_frames"] = score.first_touch_delay_frames;
}

void score_anchor(const TruthFolder& truth, const ResultFolder& result, Json& scores) {
  scores["jitter_mm"] = nullptr;
  if (!result.every_frame_has_a_pose()) return;  // those left out might be the worst ones
  AnchorScorer anchor;
  for (std::size_t f = 0; f < truth.trajectory.size(); ++f) {
    const std::optional<Rigid3> pose = result.pose_at(static_cast<int>(f));
    if (pose && result.processed[f] != 0) anchor.add(truth.trajectory[f].world_from_camera, *pose);
  }
  const std::optional<double> jitter = anchor.jitter();
  scores["jitter_mm"] = jitter ? Json(1e3 * *jitter) : nullptr;
}

void score_rows(const TruthFolder& truth, const ResultFolder& result, Json& scores) {
  scores["row_error_px"] = nullptr;
  if (!result.corrections) return;
  const int second = static_cast<int>(std::lround(truth.frames_per_second));
  std::vector<std::uint8_t> looked_at;
  for (const TrueRowOffset& row : truth.rows)
    looked_at.push_back(result.processed[static_cast<std::size_t>(row.frame)]);
  scores["row_error_px"] =
      Json(largest_row_error(truth.rows, *result.corrections, second, looked_at));
}

std::string text_of(const Json& value, int digits) {
  if (value.is_null()) return "-";
  if (value.is_integer()) return fmt::format("{}", value.get<int>());
  return fmt::format("{:.{}f}", value.get<double>(), digits);
}

void print_depth(const Json& scores) {
  if (scores["depth_median"].is_null()) return;
  fmt::print("depth at (m)    median error   within 1 %   (the paper's camera: 1 to 9 %)\n");
  for (const auto& [distance, median] : scores["depth_median"].items()) {
    if (median.is_null()) continue;
    fmt::print("{:>12}{:>15.2f} %{:>11.1f} %\n", distance, 100 * median.get<double>(),
               100 * scores["depth_within_1pct"][distance].get<double>());
  }
}

void print(const Json& scores) {
  const auto line = [&](const char* text, const char* key, const char* unit, int digits) {
    const Json& value = scores[key];
    fmt::print("{:<44}{}{}\n", text, text_of(value, digits), value.is_null() ? "" : unit);
  };
  line("frames", "frames", "", 0);
  line("frames whose depth is scored", "depth_frames", "", 0);
  print_depth(scores);
  line("near hand within 1 %", "hand_within_1pct", "", 3);
  line("too close, but called far", "too_close_called_far", "", 4);
  line("camera path, absolute error", "ate_mm", " mm", 2);
  line("  share of the path that was found", "trajectory_share", "", 3);
  line("camera path, error over 1 s", "rpe_mm", " mm", 2);
  line("what moves, intersection over union", "moving_iou", "", 3);
  line("what moves, found", "moving_recall", "", 3);
  line("called moving and is not, of all pixels", "moving_false", "", 5);
  line("frames with a true touch", "frames_touching", "", 0);
  line("first touch felt after the true one by", "first_touch_delay_frames", " frames", 0);
  line("felt touches that are true", "touch_precision", "", 3);
  line("true touches that are felt", "touch_recall", "", 3);
  line("  at the right site", "touch_site", "", 3);
  line("penetration left, median", "penetration_median_mm", " mm", 2);
  line("penetration left, 99 of 100", "penetration_p99_mm", " mm", 2);
  line("largest unexplained jump of the surface", "largest_pop_mm", " mm", 2);
  if (scores.contains("reduction_error")) {
    fmt::print("{:<44}{:.2e}\n", "error of the reduced model, pooled",
               scores["reduction_error"].get<double>());
  }
  line("frames whose occlusion is scored", "occlusion_frames", "", 0);
  line("visible body, intersection over union", "occlusion_iou", "", 3);
  line("  where a hand hides part of it", "occlusion_iou_where_hidden", "", 3);
  line("  in the worst frame", "occlusion_iou_worst_frame", "", 3);
  line("border between body and hand is off by", "edge_error_px", " px", 1);
  line("flicker", "flicker", "", 4);
  line("jitter of the body in the world", "jitter_mm", " mm", 2);
  line("rows out of line, at worst", "row_error_px", " px", 2);
}

void score(const Options& options) {
  const TruthFolder truth = read_truth_folder(options.truth);
  const ResultFolder result = read_result_folder(options.result, truth.frames);
  std::optional<ReducedBody> body;
  if (!options.body.empty()) body = value_or_throw(read_pressable_body(options.body));

  Json scores;
  scores["frames"] = truth.frames;
  ProgressBar bar;
  score_images(truth, result, bar.progress(), scores);
  bar.finish();
  score_trajectories(truth, result, scores);
  score_touching(truth, result, scores);
  score_surface(truth, result, body ? &*body : nullptr, scores);
  score_anchor(truth, result, scores);
  score_rows(truth, result, scores);
  if (body) {
    scores["reduction_error"] = body->error.displacement_pooled;
    scores["reduction_error_worst"] = body->error.displacement_worst;
  }
  if (options.json) {
    fmt::print("{}\n", scores.dump(2));
  } else {
    print(scores);
  }
}

}  // namespace

void add_score(Command app) {
  auto options = std::make_shared<Options>();
  Command command = app.add_subcommand("score", "Compare a run with the truth of what it saw");
  command
      .add_option("truth", options->truth,
                  "Folder of the truth: truth/ of palpable synth, or one like it")
      .required();
  command
      .add_option("result", options->result,
                  "What a run left: the --out folder of palpable live, or another system's files")
      .required();
  command.add_option("--body", options->body,
                     "The body of the run: adds what is left of the hand in it, and its jumps");
  command.add_flag("--json", options->json, "One JSON object on stdout");
  command.footer(
      "Formats and scores: docs/benchmark.md. What a result does not hold is null (-).\n"
      "Example: palpable score clip/truth out --body bunny.palpable");
  command.callback([options] { score(*options); });
}

}  // namespace palpable::app
