#include "palpable/bake/touch_bake/touch_scenes.h"

#include "palpable/common/base/contract.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace palpable {
namespace {

using Eigen::Vector3d;

constexpr double kLowest = 0.15;        // ratio to the height; vertices below are not pressed
constexpr double kNormalWidth = 0.012;  // m, radius over which the skin's normal is averaged
constexpr double kFar = 0.2;            // m, distance at which a thing starts
constexpr double kTouches = 2e-5;       // m, gap below which it counts as touching

// The smallest gap of the skin's vertices and its triangles' centroids, m.
double smallest_gap(const SurfaceMesh& mesh, const Obstacle& obstacle) {
  const ObstacleGaps gaps(obstacle);
  double smallest = std::numeric_limits<double>::infinity();
  const auto include_point = [&](const Vector3d& x) {
    smallest = std::min(smallest, gaps.distance(x));
  };
  for (int v = 0; v < mesh.vertex_count(); ++v) include_point(mesh.vertices.col(v));
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    include_point((mesh.vertices.col(mesh.triangles(0, t)) +
                   mesh.vertices.col(mesh.triangles(1, t)) +
                   mesh.vertices.col(mesh.triangles(2, t))) /
                  3);
  }
  return smallest;
}

Obstacle shifted(const Obstacle& obstacle, const Vector3d& way) {
  Rigid3 shift = Rigid3::Identity();
  shift.translation() = way;
  return moved(obstacle, shift);
}

// The obstacle moved along `way` from afar until it just touches the skin. Each step is 0.9 of the
// smallest gap, so that it never enters the skin.
Obstacle brought(const SurfaceMesh& skin, const Obstacle& obstacle, const Vector3d& way) {
  Obstacle now = shifted(obstacle, -kFar * way);
  for (double gone = 0; gone < 2 * kFar;) {
    const double gap = smallest_gap(skin, now);
    if (gap < kTouches) break;
    now = shifted(now, 0.9 * gap * way);
    gone += 0.9 * gap;
  }
  return now;
}

// A thing whose touching side is at the position `at`. @param out  unit normal of the skin.
// @param along  unit, tangent to the skin; sets the thing's orientation
Obstacle thing_at(PressingThing thing, const Vector3d& at, const Vector3d& out,
                  const Vector3d& along) {
  const Vector3d across = out.cross(along);
  Obstacle o;
  const auto add = [&](const Vector3d& a, const Vector3d& b, double r) {
    o.capsules.push_back({a, b, r, r});
  };
  switch (thing) {
    case PressingThing::kFinger:
    case PressingThing::kSqueeze: {
      const Vector3d tip = at + 0.008 * out;
      o.capsules.push_back({tip, tip + 0.06 * (out + 0.5 * along).normalized(), 0.008, 0.009});
      break;
    }
    case PressingThing::kPencil: {
      const Vector3d tip = at + 0.0035 * out;
      add(tip, tip + 0.1 * (out + 0.6 * along).normalized(), 0.0035);
      break;
    }
    case PressingThing::kPalm:
      o.capsules.push_back(ball(at + 0.15 * out, 0.15));
      break;
    case PressingThing::kHand:
      for (int i = 0; i < 4; ++i) {
        const Vector3d middle = at + 0.009 * out + (i - 1.5) * 0.018 * across;
        add(middle - 0.04 * along, middle + 0.04 * along, 0.009);
      }
      break;
    case PressingThing::kRim: {
      constexpr int kHalf = 20, kPieces = 2 * kHalf;
      const auto on_ring = [&](int i) -> Vector3d {
        const double angle = std::numbers::pi * (i - kHalf) / kPieces;
        return at + 0.043 * out - 0.04 * (std::cos(angle) * out - std::sin(angle) * along);
      };
      for (int i = 0; i < kPieces; ++i) add(on_ring(i), on_ring(i + 1), 0.003);
      break;
    }
  }
  return o;
}

// The vertex on the opposite side of the body that is closest to the line from a vertex against its
// normal; -1: none.
int opposite(const SkinResponse& skin, int vertex, const Vector3d& normal) {
  const auto& X = skin.skin().vertices;
  int best = -1;
  double least = std::numeric_limits<double>::infinity();
  for (int v = 0; v < skin.vertex_count(); ++v) {
    const Vector3d way = X.col(v) - X.col(vertex);
    const double through = -way.dot(normal);
    if (skin.fixed()[v] != 0 || through < 0.004 || skin.normals().col(v).dot(normal) > -0.3) {
      continue;
    }
    const double off = (way + through * normal).norm() + 0.05 * through;
    if (off >= least) continue;
    least = off;
    best = v;
  }
  return best;
}

}  // namespace

Obstacle obstacle_at(const TouchScene& scene, double depth) {
  Obstacle obstacle = shifted(scene.touching, depth * scene.way);
  const Obstacle other = shifted(scene.other, -depth * scene.way);
  obstacle.capsules.insert(obstacle.capsules.end(), other.capsules.begin(), other.capsules.end());
  return obstacle;
}

std::vector<TouchScene> touch_scenes(const SkinResponse& skin, PressingThing thing, int each,
                                     std::uint64_t seed) {
  const SurfaceMesh& mesh = skin.skin();
  const double lowest = mesh.vertices.row(2).minCoeff(), highest = mesh.vertices.row(2).maxCoeff();
  std::vector<int> places;
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const bool is_high = mesh.vertices(2, v) > lowest + kLowest * (highest - lowest);
    if (skin.fixed()[v] == 0 && is_high) places.push_back(v);
  }
  PALPABLE_EXPECT(!places.empty(), "a body has vertices that can be pressed");
  std::mt19937_64 random(seed * kPressingThings + static_cast<std::uint64_t>(thing));
  std::vector<TouchScene> scenes;
  for (int tries = 0; static_cast<int>(scenes.size()) < each && tries < 100 * each; ++tries) {
    const int vertex = places[random() % places.size()];
    const double turn = 2 * std::numbers::pi * static_cast<double>(random() % 360) / 360;
    const Vector3d out = skin.mean_normal(vertex, kNormalWidth);
    const Vector3d along = Eigen::AngleAxisd(turn, out) * Vector3d(out.unitOrthogonal());
    TouchScene scene{thing, {}, -out, {}};
    scene.touching = brought(mesh, thing_at(thing, mesh.vertices.col(vertex), out, along), -out);
    if (thing == PressingThing::kSqueeze) {
      const int behind = opposite(skin, vertex, out);
      if (behind < 0) continue;
      scene.other = brought(mesh, thing_at(thing, mesh.vertices.col(behind), -out, along), out);
    }
    scenes.push_back(std::move(scene));
  }
  return scenes;
}

}  // namespace palpable
