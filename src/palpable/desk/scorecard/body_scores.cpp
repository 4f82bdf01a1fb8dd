#include "palpable/desk/scorecard/body_scores.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/desk/score/deformation_scores.h"
#include "palpable/desk/score/skin_scores.h"
#include "palpable/desk/score/touch_scores.h"
#include "palpable/desk/scorecard/drawn_skins.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <utility>

namespace palpable {
namespace {

// For each frame whether something touches (1 or 0), and the touched site (-1: none).
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

void add_touch_scores(const TruthFolder& truth, const ResultFolder& result, BodyScores& scores) {
  if (truth.contacts.empty()) return;
  const Touching is = true_touching(truth);
  const Touching felt = found_touching(truth, result);
  const TouchScore score = score_touches(is.any, felt.any);
  scores.frames_touching = score.truly_touching;
  if (!result.touches) return;
  scores.touch_precision = score.precision;
  scores.touch_recall = score.recall;
  scores.touch_site_accuracy = score_sites(is.site, felt.site);
  scores.first_touch_delay_frames = score.first_touch_delay_frames;
  std::vector<TrueReach> reach;
  std::vector<std::optional<double>> gaps;
  for (const TrueContact& contact : truth.contacts) {
    reach.push_back({contact.depth, contact.seen_share});
    gaps.push_back(contact.gap);
  }
  scores.touch_recall_3mm = touch_recall(reach, felt.any);
  scores.touch_false_discovery_5mm = touch_false(gaps, felt.any);
}

// Whether something truly touches the body and does not pass through it.
bool is_pressed(const TruthFolder& truth, int frame, const DrawnSkins& skins) {
  if (truth.contacts.empty() || !truth.contacts[frame].touching) return false;
  const std::optional<double> deepest = skins.deepest_scored();
  return !deepest || truth.contacts[frame].depth <= *deepest;
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

// How deep the hand reaches into the drawn skin, m.
double penetration(const DrawnFrame& drawn, const std::vector<Capsule>& hand) {
  SurfaceMesh in_camera = drawn.skin;
  in_camera.vertices = (drawn.camera_from_body.linear() * in_camera.vertices).colwise() +
                       drawn.camera_from_body.translation();
  return deepest_penetration(in_camera, hand);
}

void count_frames(const TruthFolder& truth, const DrawnSkins& skins, BodyScores& scores) {
  if (truth.contacts.empty()) return;
  if (const std::optional<double> deepest = skins.deepest_scored()) {
    scores.frames_too_deep = static_cast<int>(
        std::count_if(truth.contacts.begin(), truth.contacts.end(),
                      [&](const TrueContact& contact) { return contact.depth > *deepest; }));
  }
  scores.frames_touch_unseen = 0;
  for (int frame = 0; frame < truth.frames; ++frame) {
    *scores.frames_touch_unseen += is_pressed(truth, frame, skins) && !truth.is_seen(frame);
  }
}

void add_penetrations_and_pops(const TruthFolder& truth, const ResultFolder& result,
                               DrawnSkins& skins, BodyScores& scores) {
  std::vector<double> seen, unseen;  // m, penetration
  bool penetrations_known = true;
  PopScorer pops;
  for (int frame = 0; frame < truth.frames; ++frame) {
    const auto hand = truth.hands.find(frame);
    const bool pressed = hand != truth.hands.end() && is_pressed(truth, frame, skins);
    const bool processed = result.processed[frame] != 0;
    if (!processed && !pressed) continue;
    std::optional<DrawnFrame> drawn = drawn_in(frame, truth, result, skins);
    // A processed frame of unknown shape might be the worst one: then there is no score. So might
    // one that was not processed be for the penetration.
    if (processed && !drawn) return;
    penetrations_known = penetrations_known && drawn;
    if (pressed && drawn) {
      (truth.is_seen(frame) ? seen : unseen).push_back(penetration(*drawn, hand->second));
    }
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
  if (penetrations_known && !seen.empty()) {
    scores.penetration_median_mm = 1e3 * percentile(seen, 0.5);
    scores.penetration_p99_mm = 1e3 * percentile(seen, 0.99);
  }
  if (penetrations_known && !unseen.empty()) {
    scores.penetration_median_mm_unseen = 1e3 * percentile(unseen, 0.5);
  }
  if (pops.largest()) {
    scores.largest_jump_mm = 1e3 * pops.largest()->size;
    scores.largest_jump_frame = pops.largest()->frame;
  }
  scores.jumps_above_4mm = pops.counted();
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

// m; in shallower touches the camera's noise dominates a relative error.
constexpr double kDeep = 0.004;

bool is_deep(const DeformedLine& line) { return line.depth >= kDeep; }

// The lines of the truth that are scored: marked as such and not too deep.
std::vector<DeformedLine> scored_lines(const TruthFolder& truth, const DrawnSkins& skins) {
  std::vector<DeformedLine> lines;
  for (const DeformedLine& line : truth.deformed->lines) {
    if (line.scored && line.depth <= *skins.deepest_scored()) lines.push_back(line);
  }
  return lines;
}

ValuedSurface true_skin(const TruthFolder& truth, int frame) {
  const std::filesystem::path path = deformed_skin_file(truth.part / "deformed", frame);
  ValuedSurface skin = value_or_throw(read_valued_ply(path, kVonMisesProperty));
  const int count = truth.deformed->rest.vertex_count();
  if (skin.surface.vertex_count() != count) {
    throw Error(fmt::format("{}: {} vertices, but rest.ply has {}", path.string(),
                            skin.surface.vertex_count(), count));
  }
  const auto& triangles = truth.deformed->rest.triangles;
  if (skin.surface.triangles.cols() != triangles.cols() || skin.surface.triangles != triangles) {
    throw Error(fmt::format("{}: has other triangles than rest.ply", path.string()));
  }
  return skin;
}

// The touched places on the skin at rest: where the true skin touches the hand. If the truth lacks
// the pose of hand or body, the one contact point that it names; without such a point, the vertex
// that moves farthest.
std::vector<Eigen::Vector3d> places_of(const TruthFolder& truth, const DeformedLine& line,
                                       const SurfaceMesh& skin) {
  const SurfaceMesh& rest = truth.deformed->rest;
  std::vector<Eigen::Vector3d> places = touched_places(rest, skin, truth.hand_at_body(line.frame));
  if (!places.empty()) return places;
  if (!truth.contacts.empty() && truth.contacts[line.frame].point) {
    return {*truth.contacts[line.frame].point};
  }
  if (line.point) return {*line.point};
  Eigen::Index farthest = 0;
  (skin.vertices - rest.vertices).colwise().squaredNorm().maxCoeff(&farthest);
  return {rest.vertices.col(farthest)};
}

// The errors of the drawn skin over the deep frames of one kind, seen or unseen.
class DeepErrors {
 public:
  // @param stress  nothing: not known
  void add(const DisplacementError& error, std::optional<double> stress) {
    relative_.push_back(error.relative);
    worst_mm_.push_back(1e3 * error.worst);
    stress_known_ = stress_known_ && stress;
    if (stress) stress_.push_back(*stress);
  }

  // Of BodyScores or UnseenScores.
  // @pre scores.by_frame are the added frames, in the same order
  template <class Scores>
  void write(Scores& scores) const {
    scores.displacement_error = median_and_p90(relative_);
    scores.max_vertex_error_mm = median_and_p90(worst_mm_);
    if (stress_known_) scores.von_mises_error = median_and_p90(stress_);
    for (std::size_t k = 0; k < relative_.size(); ++k) {
      scores.by_frame[k].displacement_error = relative_[k];
      scores.by_frame[k].max_vertex_error_mm = worst_mm_[k];
      if (stress_known_) scores.by_frame[k].von_mises_error = stress_[k];
    }
  }

 private:
  std::vector<double> relative_, worst_mm_, stress_;
  bool stress_known_ = true;
};

// Collects the errors of the drawn skin over all frames.
class SkinErrors {
 public:
  SkinErrors(const TruthFolder& truth, const ResultFolder& result, DrawnSkins& skins)
      : truth_(truth),
        result_(result),
        skins_(skins),
        areas_(vertex_areas(truth.deformed->rest)),
        onto_true_skin_(*skins.rest(), truth.deformed->rest.vertices) {}

  // @return false when the result does not contain the skin that it drew in this frame
  bool add(const DeformedLine& line) {
    const std::optional<Found> found = found_in(line.frame);
    if (!found) return false;
    const ValuedSurface skin = true_skin(truth_, line.frame);
    const SurfaceMesh& rest = truth_.deformed->rest;
    const Eigen::Matrix3Xd u = skin.surface.vertices - rest.vertices;
    const DisplacementError error = displacement_error(u, found->displacement, areas_);
    std::optional<double> stress;
    if (found->stress.size() > 0 && skin.values.size() > 0) {
      stress = von_mises_error(skin.values, found->stress);
    }
    if (!truth_.is_seen(line.frame)) {
      unseen_mm_.push_back(1e3 * error.worst);
      if (is_deep(line)) unseen_.add(error, stress);
      return true;
    }
    overpress_mm_.push_back(1e3 * overpress(rest.vertices, u, found->displacement,
                                            places_of(truth_, line, skin.surface)));
    if (!is_deep(line)) {
      shallow_mm_.push_back(1e3 * error.worst);
      return true;
    }
    seen_.add(error, stress);
    return true;
  }

  // @pre scores.by_frame are the deep and seen frames among the added ones, scores.unseen->by_frame
  // the deep and unseen ones, in the same order
  void write(BodyScores& scores) const {
    seen_.write(scores);
    unseen_.write(*scores.unseen);
    scores.max_vertex_error_mm_shallow = median_and_p90(shallow_mm_);
    scores.max_vertex_error_mm_unseen = median_and_p90(unseen_mm_);
    scores.excess_indentation_mm = p50_and_p99(overpress_mm_);
  }

 private:
  // The result at the vertices of the true skin.
  struct Found {
    Eigen::Matrix3Xd displacement;  // m
    Eigen::VectorXd stress;         // Pa; empty: not known
  };

  [[nodiscard]] std::optional<Found> found_in(int frame) {
    const Eigen::Index N = truth_.deformed->rest.vertices.cols();
    if (result_.processed[frame] == 0) {
      return Found{Eigen::Matrix3Xd::Zero(3, N), Eigen::VectorXd::Zero(N)};
    }
    const std::optional<ValuedSurface> drawn = skins_.at(frame, Stress::kWanted);
    if (!drawn) return std::nullopt;
    Found found{onto_true_skin_.vectors(drawn->surface.vertices - skins_.rest()->vertices), {}};
    if (drawn->values.size() > 0) found.stress = onto_true_skin_.numbers(drawn->values);
    return found;
  }

  const TruthFolder& truth_;
  const ResultFolder& result_;
  DrawnSkins& skins_;
  Eigen::VectorXd areas_;
  SkinProjection onto_true_skin_;
  DeepErrors seen_, unseen_;
  std::vector<double> shallow_mm_, unseen_mm_, overpress_mm_;
};

void add_skin_scores(const TruthFolder& truth, const ResultFolder& result,
                     const std::vector<DeformedLine>& lines, DrawnSkins& skins,
                     BodyScores& scores) {
  if (!skins.rest()) return;
  SkinErrors errors(truth, result, skins);
  for (const DeformedLine& line : lines) {
    if (!errors.add(line)) return;
  }
  errors.write(scores);
}

// The force of a touch on the body, N, body frame: the force in the result, else the load of the
// touch's site at its level.
std::optional<Eigen::Vector3d> force_of(const FoundTouch& touch, const ReducedBody* body) {
  if (touch.force) return touch.force;
  if (body == nullptr || touch.site < 0 || touch.site >= std::ssize(body->sites) || !touch.level) {
    return std::nullopt;
  }
  const Site& site = body->sites[touch.site];
  return *touch.level * site.full_load * site.direction;
}

// A frame that was not processed counts as without a touch, as in the other scores of touches.
// @param lines   the lines of scores.by_frame
// @param scores  BodyScores or UnseenScores
template <class Scores>
void add_force_scores(const ResultFolder& result, const std::vector<DeformedLine>& lines,
                      const ReducedBody* body, Scores& scores) {
  if (!result.touches) return;
  std::vector<double> errors;
  for (const DeformedLine& line : lines) {
    std::vector<Eigen::Vector3d> felt;
    const auto touches = result.touches->find(line.frame);
    if (touches != result.touches->end() && result.processed[line.frame] != 0) {
      for (const FoundTouch& touch : touches->second) {
        const std::optional<Eigen::Vector3d> force = force_of(touch, body);
        if (!force) return;
        felt.push_back(*force);
      }
    }
    errors.push_back(force_error(line.force, felt));
  }
  scores.force_error = median_and_p90(errors);
  for (std::size_t k = 0; k < errors.size(); ++k) scores.by_frame[k].force_error = errors[k];
}

void add_deformed_scores(const TruthFolder& truth, const ResultFolder& result,
                         const ReducedBody* body, DrawnSkins& skins, BodyScores& scores) {
  if (!truth.deformed) return;
  const std::vector<DeformedLine> lines = scored_lines(truth, skins);
  scores.reference_frames = 0;
  scores.reference_frames_shallow = 0;
  scores.reference_frames_unseen = 0;
  scores.unseen.emplace();
  std::vector<DeformedLine> deep, deep_unseen;
  for (const DeformedLine& line : lines) {
    if (!truth.is_seen(line.frame)) {
      ++*scores.reference_frames_unseen;
      if (!is_deep(line)) continue;
      ++scores.unseen->frames;
      scores.unseen->by_frame.emplace_back().frame = line.frame;
      deep_unseen.push_back(line);
    } else if (!is_deep(line)) {
      ++*scores.reference_frames_shallow;
    } else {
      ++*scores.reference_frames;
      scores.by_frame.emplace_back().frame = line.frame;
      deep.push_back(line);
    }
  }
  add_skin_scores(truth, result, lines, skins, scores);
  add_force_scores(result, deep, body, scores);
  add_force_scores(result, deep_unseen, body, *scores.unseen);
}

}  // namespace

BodyScores score_body(const TruthFolder& truth, const ResultFolder& result,
                      const ReducedBody* body) {
  BodyScores scores;
  add_touch_scores(truth, result, scores);
  DrawnSkins skins(truth, result, body);
  count_frames(truth, skins, scores);
  scores.placement_error_mm = score_placement(truth, result, skins);
  add_penetrations_and_pops(truth, result, skins, scores);
  add_deformed_scores(truth, result, body, skins, scores);
  return scores;
}

}  // namespace palpable
