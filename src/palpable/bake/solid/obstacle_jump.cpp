#include "palpable/bake/solid/obstacle_jump.h"

#include "palpable/common/geometry/size_text.h"
#include "palpable/common/geometry/surface_distance.h"

#include <Eigen/Geometry>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

using Eigen::Vector3d;

constexpr int kFewestSamples = 8, kMostSamples = 512;
// Penetration, ratio to the diagonal of the body's box, from which an overlap is no rounding error.
constexpr double kTouch = 1e-5;
// Number of steps that should end inside the overlap. With fewer, the first one would end deep
// inside the body.
constexpr double kStepsInside = 8.0;
constexpr double kMostSteps = 10000.0;  // of `palpable solve --steps`

class BodyInTheWay {
 public:
  explicit BodyInTheWay(const SurfaceMesh& skin)
      : skin_(skin),
        box_(skin.vertices.rowwise().minCoeff(), skin.vertices.rowwise().maxCoeff()),
        distance_(skin) {}

  [[nodiscard]] const Eigen::AlignedBox3d& box() const { return box_; }

  [[nodiscard]] bool overlaps(const ObstacleGaps& gaps, OverlapOf what) const {
    const double least = -kTouch * box_.diagonal().norm();
    for (int part = 0; part < gaps.part_count(); ++part) {
      if (!gaps.may_reach(part, box_)) continue;
      const bool any = what == OverlapOf::kAnyPoint;
      for (Eigen::Index v = 0; any && v < skin_.vertices.cols(); ++v) {
        if (gaps.distance(part, skin_.vertices.col(v)) < least) return true;
      }
      // A thin part goes in between the vertices.
      for (const Vector3d& x : gaps.core(part)) {
        if (box_.contains(x) && distance_.nearest(x).distance < least) return true;
      }
    }
    return false;
  }

 private:
  const SurfaceMesh& skin_;
  Eigen::AlignedBox3d box_;
  SurfaceDistance distance_;
};

// m: how far the parts of the obstacle go between two times, at the body.
double travel(const Obstacle& from, const Obstacle& to, const Vector3d& x) {
  double farthest = 0.0;
  for (int part = 0; part < from.part_count(); ++part) {
    farthest = std::max(farthest, (carried(from, to, part, x) - x).norm());
  }
  return farthest;
}

}  // namespace

std::optional<Overlap> overlap_between(const ObstacleMotion& motion, const SurfaceMesh& skin,
                                       double from, double to, OverlapOf what) {
  const BodyInTheWay body(skin);
  const double apart = body.box().sizes().minCoeff() / 8.0;
  const double way = travel(motion(from), motion(to), body.box().center());
  const int samples =
      static_cast<int>(std::clamp(std::ceil(way / apart), static_cast<double>(kFewestSamples),
                                  static_cast<double>(kMostSamples)));
  const double step = (to - from) / samples;
  std::optional<Overlap> found;
  for (int k = 1; k < samples; ++k) {
    const double t = from + k * step;
    if (!body.overlaps(ObstacleGaps(motion(t)), what)) continue;
    if (!found) found = Overlap{t - 0.5 * step, t};
    found->end = t + 0.5 * step;
  }
  return found;
}

int steps_to_meet(const Overlap& overlap) {
  return static_cast<int>(
      std::min(std::ceil(kStepsInside / (overlap.end - overlap.begin)), kMostSteps));
}

std::string swallowed_text(const Obstacle& obstacle, const SurfaceMesh& skin) {
  const ObstacleGaps gaps(obstacle);
  const auto capsules = static_cast<int>(obstacle.capsules.size());
  const auto planes = capsules + static_cast<int>(obstacle.half_spaces.size());
  for (int part = 0; part < gaps.part_count(); ++part) {
    const bool outside =
        std::any_of(skin.vertices.colwise().begin(), skin.vertices.colwise().end(),
                    [&](const auto& x) { return gaps.distance(part, Vector3d(x)) >= 0.0; });
    if (outside) continue;
    if (capsules <= part && part < planes) {
      return "the body lies behind the plane at the start, in its solid: the normal points out of "
             "the solid, towards the body; reverse it";
    }
    return fmt::format(
        "the body ({}) lies inside the obstacle at the start: lengths are metres (or have their "
        "unit: 8mm)",
        size_text(extent_of(skin.vertices)));
  }
  return {};
}

}  // namespace palpable
