#include "palpable/desk/scorecard/scorecard.h"

#include "palpable/common/base/error.h"
#include "palpable/desk/score/camera_scores.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace palpable {
namespace {

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
    scores.trajectory_coverage =
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

// Jitter of the drawn body in the world, mm.
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

// Largest row error, px of the full-size picture.
std::optional<double> score_rows(const TruthFolder& truth, const ResultFolder& result) {
  if (!result.corrections) return std::nullopt;
  const int second = static_cast<int>(std::lround(truth.frames_per_second));
  std::vector<std::uint8_t> processed;
  for (const TrueRowOffset& row : truth.rows) { processed.push_back(result.processed[row.frame]); }
  return largest_row_error(truth.rows, *result.corrections, second, processed);
}

}  // namespace

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
  scores.truth = truth_path.string();
  scores.result = result_path.string();
  scores.film = truth.film;
  scores.speed = result.speed;
  scores.frames = truth.frames;
  scores.frames_processed =
      static_cast<int>(std::count(result.processed.begin(), result.processed.end(), 1));
  scores.images = score_images(truth, result, progress);
  scores.path = score_path(truth, result);
  if (names.empty()) scores.body = score_body(truth, result, body);
  for (const std::string& name : names) {
    const TruthFolder its_truth = read_truth_folder(truth_path, name);
    const ResultFolder its_result = read_result_folder(result_path, its_truth.frames, name);
    scores.bodies.push_back(score_body(its_truth, its_result, nullptr));
    scores.bodies.back().name = name;
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
