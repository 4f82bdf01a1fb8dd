#include "palpable/desk/scorecard/deformed_scores.h"

#include "palpable/common/base/error.h"
#include "palpable/desk/score/deformation_scores.h"
#include "palpable/desk/scorecard/drawn_skins.h"

#include <fmt/core.h>

#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;

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
  const fs::path path = deformed_skin_file(truth.part / "deformed", frame);
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
    if (!truth_.is_seen(line.frame)) {
      unseen_mm_.push_back(1e3 * error.worst);
      return true;
    }
    overpress_mm_.push_back(1e3 * overpress(rest.vertices, u, found->displacement,
                                            places_of(truth_, line, skin.surface)));
    if (!is_deep(line)) {
      shallow_mm_.push_back(1e3 * error.worst);
      return true;
    }
    relative_.push_back(error.relative);
    worst_mm_.push_back(1e3 * error.worst);
    if (found->stress.size() == 0 || skin.values.size() == 0) {
      stress_known_ = false;
    } else {
      stress_.push_back(von_mises_error(skin.values, found->stress));
    }
    return true;
  }

  // @pre scores.frames are the deep and seen frames among the added ones, in the same order
  void write(DeformedScores& scores) const {
    scores.displacement_error = median_and_p90(relative_);
    scores.displacement_error_mm = median_and_p90(worst_mm_);
    scores.displacement_error_mm_shallow = median_and_p90(shallow_mm_);
    scores.displacement_error_mm_unseen = median_and_p90(unseen_mm_);
    scores.overpress_mm = p50_and_p99(overpress_mm_);
    if (stress_known_) scores.von_mises_error = median_and_p90(stress_);
    for (std::size_t k = 0; k < relative_.size(); ++k) {
      scores.frames[k].displacement_error = relative_[k];
      scores.frames[k].displacement_error_mm = worst_mm_[k];
      if (stress_known_) scores.frames[k].von_mises_error = stress_[k];
    }
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
  std::vector<double> relative_, worst_mm_, shallow_mm_, unseen_mm_, stress_, overpress_mm_;
  bool stress_known_ = true;
};

void add_skin_scores(const TruthFolder& truth, const ResultFolder& result,
                     const std::vector<DeformedLine>& lines, DrawnSkins& skins,
                     DeformedScores& scores) {
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
// @param lines  the lines of scores.frames
void add_force_scores(const ResultFolder& result, const std::vector<DeformedLine>& lines,
                      const ReducedBody* body, DeformedScores& scores) {
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
  for (std::size_t k = 0; k < errors.size(); ++k) scores.frames[k].force_error = errors[k];
}

}  // namespace

DeformedScores score_deformed(const TruthFolder& truth, const ResultFolder& result,
                              const ReducedBody* body) {
  DeformedScores scores;
  if (!truth.deformed) return scores;
  DrawnSkins skins(truth, result, body);
  const std::vector<DeformedLine> lines = scored_lines(truth, skins);
  scores.deformed_frames = 0;
  scores.deformed_frames_shallow = 0;
  scores.deformed_frames_unseen = 0;
  std::vector<DeformedLine> deep;
  for (const DeformedLine& line : lines) {
    if (!truth.is_seen(line.frame)) {
      ++*scores.deformed_frames_unseen;
    } else if (!is_deep(line)) {
      ++*scores.deformed_frames_shallow;
    } else {
      ++*scores.deformed_frames;
      scores.frames.emplace_back().frame = line.frame;
      deep.push_back(line);
    }
  }
  add_skin_scores(truth, result, lines, skins, scores);
  add_force_scores(result, deep, body, scores);
  return scores;
}

}  // namespace palpable
