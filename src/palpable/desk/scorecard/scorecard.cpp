#include "palpable/desk/scorecard/scorecard.h"

#include "palpable/common/base/error.h"
#include "palpable/desk/score/camera_scores.h"
#include "palpable/desk/score/touch_scores.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

namespace palpable {
namespace {

/// For each frame whether something touches (1 or 0), and the touched site (-1: none).
struct Touching {
  explicit Touching(int frames) : any(frames, std::uint8_t{0}), site(frames, -1) {}
  std::vector<std::uint8_t> any;
  std::vector<int> site;
};

Touching true_touching(const TruthFolder& truth) {
  Touching touching(truth.frames);
  for (std::size_t f = 0; f < touching.any.size(); ++f) {
    if (!truth.contacts[f].touching) continue;
    touching.any[f] = 1;
    touching.site[f] = truth.contacts[f].site;
  }
  return touching;
}

Touching found_touching(const TruthFolder& truth, const ResultFolder& result) {
  Touching touching(truth.frames);
  if (!result.touches) return touching;
  for (const auto& [frame, touches] : *result.touches) {
    if (frame >= truth.frames) {
      throw Error(fmt::format("{}: frame {} is touched, but the truth has {} frames (from 0 on)",
                              (result.folder / "touches.jsonl").string(), frame, truth.frames));
    }
    if (result.processed[frame] == 0) continue;
    // Touches by another body are not compared with the true touches, which are those of the hand.
    const auto real = std::find_if(touches.begin(), touches.end(),
                                   [](const FoundTouch& touch) { return !touch.by_body; });
    if (real == touches.end()) continue;
    touching.any[frame] = 1;
    touching.site[frame] = real->site;
  }
  return touching;
}

}  // namespace

PathScores score_path(const TruthFolder& truth, const ResultFolder& result) {
  PathScores scores;
  if (truth.trajectory.empty() || !result.trajectory) return scores;
  const double half_a_frame = 0.5 / truth.frames_per_second;
  std::vector<StampedPose> processed;
  for (std::size_t f = 0; f < truth.trajectory.size(); ++f) {
    if (result.processed[f] != 0) processed.push_back(truth.trajectory[f]);
  }
  const std::vector<PosePair> pairs = match_in_time(processed, *result.trajectory, half_a_frame);
  if (!processed.empty()) {
    scores.trajectory_share =
        static_cast<double>(pairs.size()) / static_cast<double>(processed.size());
  }
  if (pairs.size() < 2) return scores;  // a single pose can be aligned with any other
  const TrajectoryScore score = score_trajectory(pairs);
  scores.ate_mm = 1e3 * score.ate;
  if (!score.rpe) return scores;
  scores.rpe_mm = 1e3 * *score.rpe;
  scores.rpe_deg = *score.rpe_angle * 180 / std::numbers::pi;
  return scores;
}

PressScores score_presses(const TruthFolder& truth, const ResultFolder& result) {
  PressScores scores;
  if (truth.contacts.empty()) return scores;
  const Touching is = true_touching(truth);
  const Touching felt = found_touching(truth, result);
  const TouchScore score = score_touches(is.any, felt.any);
  scores.frames_touching = score.truly_touching;
  if (!result.touches) return scores;
  scores.touch_precision = score.precision;
  scores.touch_recall = score.recall;
  scores.touch_site = score_sites(is.site, felt.site);
  scores.first_touch_delay_frames = score.first_touch_delay_frames;
  std::vector<TrueReach> reach;
  std::vector<std::optional<double>> gaps;
  for (const TrueContact& contact : truth.contacts) {
    reach.push_back({contact.depth, contact.seen_share});
    gaps.push_back(contact.gap);
  }
  scores.touch_recall_3mm = touch_recall(reach, felt.any);
  scores.touch_false_5mm = touch_false(gaps, felt.any);
  return scores;
}

std::optional<double> score_anchor(const TruthFolder& truth, const ResultFolder& result) {
  // A frame without a pose might be the worst one: then there is no score.
  if (!result.every_frame_has_a_pose()) return std::nullopt;
  AnchorScorer anchor;
  for (std::size_t f = 0; f < truth.trajectory.size(); ++f) {
    const std::optional<Rigid3> pose = result.pose_at(static_cast<int>(f));
    if (pose && result.processed[f] != 0) anchor.add(truth.trajectory[f].world_from_camera, *pose);
  }
  const std::optional<double> jitter = anchor.jitter();
  if (!jitter) return std::nullopt;
  return 1e3 * *jitter;
}

std::optional<double> score_rows(const TruthFolder& truth, const ResultFolder& result) {
  if (!result.corrections) return std::nullopt;
  const int second = static_cast<int>(std::lround(truth.frames_per_second));
  std::vector<std::uint8_t> processed;
  for (const TrueRowOffset& row : truth.rows) { processed.push_back(result.processed[row.frame]); }
  return largest_row_error(truth.rows, *result.corrections, second, processed);
}

// Adds the scores of each body of a film with several.
void score_bodies(const std::filesystem::path& truth_path, const std::filesystem::path& result_path,
                  const std::vector<std::string>& names, Scorecard& scores) {
  for (const std::string& name : names) {
    const TruthFolder truth = read_truth_folder(truth_path, name);
    const ResultFolder result = read_result_folder(result_path, truth.frames, name);
    BodyScores& body = scores.bodies.emplace_back();
    body.name = name;
    body.press = score_presses(truth, result);
    body.surface = score_surface(truth, result, nullptr);
    body.deformed = score_deformed(truth, result, nullptr);
  }
}

Scorecard score_folders(const std::filesystem::path& truth_path,
                        const std::filesystem::path& result_path, const ReducedBody* body,
                        const Progress& progress) {
  const std::vector<std::string> names = bodies_of_truth(truth_path);
  if (!names.empty() && body != nullptr) {
    throw Error("--body is of a film with one body; of several their meshes say all");
  }
  const TruthFolder truth = read_truth_folder(truth_path);
  const ResultFolder result = read_result_folder(result_path, truth.frames);
  Scorecard scores;
  scores.frames = truth.frames;
  scores.frames_processed =
      static_cast<int>(std::count(result.processed.begin(), result.processed.end(), 1));
  scores.images = score_images(truth, result, progress);
  scores.path = score_path(truth, result);
  if (names.empty()) {
    scores.press = score_presses(truth, result);
    scores.surface = score_surface(truth, result, body);
    scores.deformed = score_deformed(truth, result, body);
  } else {
    score_bodies(truth_path, result_path, names, scores);
  }
  scores.jitter_mm = score_anchor(truth, result);
  scores.row_error_px = score_rows(truth, result);
  if (body != nullptr) {
    scores.reduction_error = body->error.displacement_pooled;
    scores.reduction_error_worst = body->error.displacement_worst;
  }
  return scores;
}

}  // namespace palpable
