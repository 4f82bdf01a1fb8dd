#include "palpable/scorecard/surface_scores.h"

#include "palpable/base/error.h"
#include "palpable/base/order_statistics.h"
#include "palpable/clip_files/frame_names.h"
#include "palpable/geometry/mesh_file.h"
#include "palpable/score/penetration.h"
#include "palpable/score/pop.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;

// What was drawn in each frame, body frame.
class Surfaces {
 public:
  Surfaces(const ResultFolder& result, const ReducedBody* body)
      : result_(result), body_(body), meshes_(fs::is_directory(result.folder / "meshes")) {
    const auto known = [](const auto& touch) {
      return touch.second.site >= 0 && touch.second.level.has_value();
    };
    // One frame of an unknown shape leaves none: the worst ones might be those.
    touches_say_it_ = body != nullptr && result.touches &&
                      std::all_of(result.touches->begin(), result.touches->end(), known);
  }

  [[nodiscard]] std::optional<SurfaceMesh> at(int frame) const {
    if (meshes_) return from_file(frame);
    if (!touches_say_it_) return std::nullopt;
    return from_touch(frame);
  }

  [[nodiscard]] fs::path file_of(int frame) const {
    return result_.folder / "meshes" / frame_name(frame, ".ply");
  }

 private:
  [[nodiscard]] std::optional<SurfaceMesh> from_file(int frame) const {
    const fs::path path = file_of(frame);
    if (!fs::exists(path)) return std::nullopt;
    return value_or_throw(read_surface_file(path));
  }

  [[nodiscard]] SurfaceMesh from_touch(int frame) const {
    const auto touch = result_.touches->find(frame);
    if (touch == result_.touches->end()) return body_->surface;
    const auto [site, level] = touch->second;
    const fs::path path = result_.folder / "touches.jsonl";
    if (site >= std::ssize(body_->sites)) {
      throw Error(fmt::format("{}: frame {} presses site {}, but {} has {} sites", path.string(),
                              frame, site, body_->name, body_->sites.size()));
    }
    Eigen::Matrix3Xf u = Eigen::Matrix3Xf::Zero(3, body_->surface.vertices.cols());
    body_->displacement.evaluate(std::array{static_cast<double>(site), *level},
                                 std::span<float>(u.data(), static_cast<std::size_t>(u.size())));
    return {body_->surface.vertices + u.cast<double>(), body_->surface.triangles};
  }

  const ResultFolder& result_;
  const ReducedBody* body_;
  bool meshes_;
  bool touches_say_it_ = false;
};

}  // namespace

SurfaceScores score_surface(const TruthFolder& truth, const ResultFolder& result,
                            const ReducedBody* body) {
  // A frame that is left out might be the worst one: then there is no score.
  if (!result.every_frame_has_a_pose()) return {};
  const Surfaces surfaces(result, body);
  std::vector<double> deepest;
  PopScorer pops;
  int vertices = 0;
  for (int frame = 0; frame < truth.frames; ++frame) {
    if (result.processed[frame] == 0) continue;
    const Rigid3 pose = *result.pose_at(frame);
    std::optional<SurfaceMesh> surface = surfaces.at(frame);
    if (!surface) return {};
    if (vertices != 0 && surface->vertex_count() != vertices) {
      throw Error(
          fmt::format("{}: {} vertices, but frames before it {}; every frame shows one body",
                      surfaces.file_of(frame).string(), surface->vertex_count(), vertices));
    }
    vertices = surface->vertex_count();
    PopFrame drawn;
    drawn.number = frame;
    drawn.camera_from_body = pose;
    if (!truth.trajectory.empty())
      drawn.world_from_camera = truth.trajectory[frame].world_from_camera;
    if (const auto hand = truth.hands.find(frame); hand != truth.hands.end()) {
      drawn.hand = hand->second;
    }
    if (!truth.contacts.empty() && truth.contacts[frame].touching && !drawn.hand.empty()) {
      SurfaceMesh in_camera = *surface;
      in_camera.vertices = (pose.linear() * surface->vertices).colwise() + pose.translation();
      deepest.push_back(deepest_penetration(in_camera, drawn.hand));
    }
    drawn.surface = std::move(surface->vertices);
    pops.add(std::move(drawn));
  }
  SurfaceScores scores;
  if (!deepest.empty()) {
    scores.penetration_median_mm = 1e3 * percentile(deepest, 0.5);
    scores.penetration_p99_mm = 1e3 * percentile(deepest, 0.99);
  }
  if (pops.largest()) {
    scores.largest_pop_mm = 1e3 * pops.largest()->size;
    scores.largest_pop_frame = pops.largest()->frame;
  }
  return scores;
}

}  // namespace palpable
