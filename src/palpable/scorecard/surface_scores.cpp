#include "palpable/scorecard/surface_scores.h"

#include "palpable/base/order_statistics.h"
#include "palpable/score/penetration.h"
#include "palpable/score/pop.h"
#include "palpable/scorecard/drawn_skins.h"

#include <optional>
#include <utility>
#include <vector>

namespace palpable {
namespace {

std::optional<int> count_too_deep(const TruthFolder& truth, const DrawnSkins& skins) {
  const std::optional<double> deepest = skins.deepest_scored();
  if (truth.contacts.empty() || !deepest) return std::nullopt;
  int count = 0;
  for (const TrueContact& contact : truth.contacts) count += contact.depth > *deepest;
  return count;
}

// Whether something truly touches, and does not pass through.
bool is_pressed(const TruthFolder& truth, int frame, const DrawnSkins& skins) {
  if (truth.contacts.empty() || !truth.contacts[frame].touching) return false;
  const std::optional<double> deepest = skins.deepest_scored();
  return !deepest || truth.contacts[frame].depth <= *deepest;
}

}  // namespace

SurfaceScores score_surface(const TruthFolder& truth, const ResultFolder& result,
                            const ReducedBody* body) {
  DrawnSkins skins(truth, result, body);
  SurfaceScores scores;
  scores.frames_too_deep = count_too_deep(truth, skins);
  // A frame that is left out might be the worst one: then there is no score.
  if (!result.every_frame_has_a_pose()) return scores;
  std::vector<double> deepest;
  PopScorer pops;
  for (int frame = 0; frame < truth.frames; ++frame) {
    if (result.processed[frame] == 0) continue;
    const Rigid3 pose = *result.pose_at(frame);
    std::optional<ValuedSurface> skin = skins.at(frame, Stress::kNotWanted);
    if (!skin) return scores;
    PopFrame drawn;
    drawn.number = frame;
    drawn.camera_from_body = pose;
    if (!truth.trajectory.empty())
      drawn.world_from_camera = truth.trajectory[frame].world_from_camera;
    if (const auto hand = truth.hands.find(frame); hand != truth.hands.end()) {
      drawn.hand = hand->second;
    }
    if (is_pressed(truth, frame, skins) && !drawn.hand.empty()) {
      SurfaceMesh in_camera = skin->surface;
      in_camera.vertices = (pose.linear() * in_camera.vertices).colwise() + pose.translation();
      deepest.push_back(deepest_penetration(in_camera, drawn.hand));
    }
    drawn.surface = std::move(skin->surface.vertices);
    pops.add(std::move(drawn));
  }
  if (!deepest.empty()) {
    scores.penetration_median_mm = 1e3 * percentile(deepest, 0.5);
    scores.penetration_p99_mm = 1e3 * percentile(deepest, 0.99);
  }
  if (pops.largest()) {
    scores.largest_pop_mm = 1e3 * pops.largest()->size;
    scores.largest_pop_frame = pops.largest()->frame;
  }
  scores.pops_4mm = pops.counted();
  return scores;
}

}  // namespace palpable
