#include "palpable/desk/scorecard/surface_scores.h"

#include "palpable/common/base/order_statistics.h"
#include "palpable/desk/score/skin_scores.h"
#include "palpable/desk/scorecard/drawn_skins.h"

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

// Whether something truly touches the body and does not pass through it.
bool is_pressed(const TruthFolder& truth, int frame, const DrawnSkins& skins) {
  if (truth.contacts.empty() || !truth.contacts[frame].touching) return false;
  const std::optional<double> deepest = skins.deepest_scored();
  return !deepest || truth.contacts[frame].depth <= *deepest;
}

std::optional<int> count_unseen(const TruthFolder& truth, const DrawnSkins& skins) {
  if (truth.contacts.empty()) return std::nullopt;
  int count = 0;
  for (int frame = 0; frame < truth.frames; ++frame) {
    count += is_pressed(truth, frame, skins) && !truth.is_seen(frame);
  }
  return count;
}

// The drawn skin of a frame, m, body frame, and the pose in which it was drawn.
struct DrawnFrame {
  SurfaceMesh skin;
  Rigid3 camera_from_body;
};

// Nothing when skin or pose is not known. A frame that was not processed counts as the body at
// rest.
std::optional<DrawnFrame> drawn_in(int frame, const TruthFolder& truth, const ResultFolder& result,
                                   DrawnSkins& skins) {
  std::optional<Rigid3> pose = result.pose_at(frame);
  if (result.processed[frame] == 0) {
    if (!pose) pose = truth.pose_at(frame);
    if (!pose || !skins.rest()) return std::nullopt;
    return DrawnFrame{*skins.rest(), *pose};
  }
  std::optional<ValuedSurface> skin = skins.at(frame, Stress::kNotWanted);
  if (!pose || !skin) return std::nullopt;
  return DrawnFrame{std::move(skin->surface), *pose};
}

// Collects the penetration of the hand into the drawn skin, m, per frame.
class Penetrations {
 public:
  // @param drawn  nothing: not known; it might be the worst frame, so there is no score
  void add(const std::optional<DrawnFrame>& drawn, const std::vector<Capsule>& hand, bool seen) {
    if (!drawn) {
      known_ = false;
      return;
    }
    SurfaceMesh in_camera = drawn->skin;
    in_camera.vertices = (drawn->camera_from_body.linear() * in_camera.vertices).colwise() +
                         drawn->camera_from_body.translation();
    (seen ? seen_ : unseen_).push_back(deepest_penetration(in_camera, hand));
  }

  void write(SurfaceScores& scores) const {
    if (!known_) return;
    if (!seen_.empty()) {
      scores.penetration_median_mm = 1e3 * percentile(seen_, 0.5);
      scores.penetration_p99_mm = 1e3 * percentile(seen_, 0.99);
    }
    if (!unseen_.empty()) scores.penetration_median_mm_unseen = 1e3 * percentile(unseen_, 0.5);
  }

 private:
  std::vector<double> seen_, unseen_;
  bool known_ = true;
};

void write_pops(const PopScorer& pops, SurfaceScores& scores) {
  if (pops.largest()) {
    scores.largest_pop_mm = 1e3 * pops.largest()->size;
    scores.largest_pop_frame = pops.largest()->frame;
  }
  scores.pops_4mm = pops.counted();
}

std::optional<MedianAndP90> score_placement(const TruthFolder& truth, const ResultFolder& result,
                                            const DrawnSkins& skins) {
  const SurfaceMesh* rest = truth.body     ? &truth.body->rest
                            : skins.rest() ? &*skins.rest()
                                           : nullptr;
  if (rest == nullptr) return std::nullopt;
  std::vector<double> errors;
  for (int frame = 0; frame < truth.frames; ++frame) {
    if (result.processed[frame] == 0) continue;
    const std::optional<Rigid3> stands = truth.pose_at(frame);
    const std::optional<Rigid3> drawn = result.pose_at(frame);
    if (!stands || !drawn) return std::nullopt;
    errors.push_back(1e3 * placement_error(rest->vertices, *stands, *drawn));
  }
  return median_and_p90(errors);
}

}  // namespace

SurfaceScores score_surface(const TruthFolder& truth, const ResultFolder& result,
                            const ReducedBody* body) {
  DrawnSkins skins(truth, result, body);
  SurfaceScores scores;
  scores.frames_too_deep = count_too_deep(truth, skins);
  scores.frames_unseen = count_unseen(truth, skins);
  scores.placement_error_mm = score_placement(truth, result, skins);
  Penetrations penetrations;
  PopScorer pops;
  for (int frame = 0; frame < truth.frames; ++frame) {
    const auto hand = truth.hands.find(frame);
    const bool pressed = hand != truth.hands.end() && is_pressed(truth, frame, skins);
    const bool processed = result.processed[frame] != 0;
    if (!processed && !pressed) continue;
    std::optional<DrawnFrame> drawn = drawn_in(frame, truth, result, skins);
    // A processed frame of unknown shape might be the worst one: then there is no score.
    if (processed && !drawn) return scores;
    if (pressed) penetrations.add(drawn, hand->second, truth.is_seen(frame));
    if (!processed) continue;
    PopFrame shown;
    shown.number = frame;
    shown.camera_from_body = drawn->camera_from_body;
    if (!truth.trajectory.empty())
      shown.world_from_camera = truth.trajectory[frame].world_from_camera;
    if (hand != truth.hands.end()) shown.hand = hand->second;
    shown.surface = std::move(drawn->skin.vertices);
    pops.add(std::move(shown));
  }
  penetrations.write(scores);
  write_pops(pops, scores);
  return scores;
}

}  // namespace palpable
