#include "palpable/common/geometry/shells.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/geometry/place_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>

namespace palpable {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

// The representative of a vertex's set (union-find with path halving).
int set_of(std::vector<int>& parents, int vertex) {
  while (parents[vertex] != vertex) vertex = parents[vertex] = parents[parents[vertex]];
  return vertex;
}

// Solid angle of a triangle seen from the origin; positive when it faces away.
double solid_angle(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return 2.0 * std::atan2(a.dot(b.cross(c)),
                          la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

// Distance along the ray to the triangle, in lengths of `direction`; nothing if the ray misses it.
std::optional<double> ray_hits(const Vector3d& from, const Vector3d& direction, const Vector3d& a,
                               const Vector3d& b, const Vector3d& c) {
  const Vector3d ab = b - a, ac = c - a, p = direction.cross(ac);
  const double determinant = ab.dot(p);
  if (determinant == 0.0) return std::nullopt;
  const Vector3d s = from - a, q = s.cross(ab);
  const double u = s.dot(p) / determinant, v = direction.dot(q) / determinant;
  if (u < 0.0 || v < 0.0 || u + v > 1.0) return std::nullopt;
  return ac.dot(q) / determinant;
}

// The point half way between the shell's largest triangle and the next triangle on the side that it
// faces.
Vector3d point_before(const SurfaceMesh& surface, const std::vector<int>& shell) {
  const auto corner = [&](int t, int k) -> Vector3d {
    return surface.vertices.col(surface.triangles(k, t));
  };
  int largest = shell.front();
  Vector3d normal = Vector3d::Zero();
  for (const int t : shell) {
    const Vector3d n = (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0));
    if (n.squaredNorm() <= normal.squaredNorm()) continue;
    largest = t;
    normal = n;
  }
  normal.normalize();
  const Vector3d middle = (corner(largest, 0) + corner(largest, 1) + corner(largest, 2)) / 3.0;
  double next = std::numeric_limits<double>::infinity();
  for (int t = 0; t < surface.triangle_count(); ++t) {
    if (t == largest) continue;
    const auto hit = ray_hits(middle, normal, corner(t, 0), corner(t, 1), corner(t, 2));
    if (hit && *hit > 0.0) next = std::min(next, *hit);
  }
  PALPABLE_EXPECT(std::isfinite(next), "a cavity has a wall on its other side");
  return middle + 0.5 * next * normal;
}

}  // namespace

std::vector<std::vector<int>> shells_of(const SurfaceMesh& surface) {
  std::vector<int> parents(surface.vertex_count());
  std::iota(parents.begin(), parents.end(), 0);
  for (const auto& t : surface.triangles.colwise()) {
    for (const int k : {1, 2}) parents[set_of(parents, t[k])] = set_of(parents, t[0]);
  }
  std::vector<int> shell_of_set(surface.vertex_count(), -1);
  std::vector<std::vector<int>> shells;
  for (int t = 0; t < surface.triangle_count(); ++t) {
    int& shell = shell_of_set[set_of(parents, surface.triangles(0, t))];
    if (shell < 0) {
      shell = static_cast<int>(shells.size());
      shells.emplace_back();
    }
    shells[shell].push_back(t);
  }
  return shells;
}

SurfaceMesh surface_of(const SurfaceMesh& surface, const std::vector<int>& triangles) {
  // A list instead of a table over all vertices: this is called once for each of thousands of
  // shells.
  std::vector<int> kept;
  for (const int t : triangles) {
    for (int k = 0; k < 3; ++k) kept.push_back(surface.triangles(k, t));
  }
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  SurfaceMesh part;
  part.vertices = surface.vertices(Eigen::all, kept);
  part.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (Eigen::Index t = 0; t < part.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int vertex = surface.triangles(k, triangles[t]);
      part.triangles(k, t) =
          static_cast<int>(std::lower_bound(kept.begin(), kept.end(), vertex) - kept.begin());
    }
  }
  return part;
}

double winding_number(const SurfaceMesh& surface, const Vector3d& point) {
  double angles = 0.0;
  for (const auto& t : surface.triangles.colwise()) {
    angles += solid_angle(surface.vertices.col(t[0]) - point, surface.vertices.col(t[1]) - point,
                          surface.vertices.col(t[2]) - point);
  }
  return angles / (4.0 * std::numbers::pi);
}

std::string misplaced_shell(const SurfaceMesh& surface) {
  const std::vector<std::vector<int>> shells = shells_of(surface);
  if (shells.size() < 2) return {};
  std::vector<SurfaceMesh> parts;
  std::vector<AlignedBox3d> boxes;
  for (const std::vector<int>& shell : shells) {
    parts.push_back(surface_of(surface, shell));
    boxes.push_back(box_of(parts.back()));
  }
  for (const SurfaceMesh& part : parts) {
    const Vector3d at = part.vertices.col(part.triangles(0, 0));
    double wound = 0.0;
    for (std::size_t other = 0; other < parts.size(); ++other) {
      // A shell does not wind around a point outside its box.
      if (&parts[other] == &part || !boxes[other].contains(at)) continue;
      wound += winding_number(parts[other], at);
    }
    const bool faces_outwards = enclosed_volume(part) > 0.0;
    const long around = std::lround(wound);
    if (around == (faces_outwards ? 0 : 1)) continue;
    const std::string shell =
        fmt::format("of {} closed shells the one at {}, with {} triangles,", shells.size(),
                    place_text(at, told_apart(surface.vertices)), part.triangle_count());
    if (around == 0) { return shell + " faces inwards but lies in no other: flip its orientation"; }
    return shell +
           (faces_outwards
                ? " lies within another and faces outwards like it: flip its orientation if it is "
                  "a cavity, join them in a mesh editor if they are one solid"
                : " is a cavity within a cavity or in several solids at once: remove it, or join "
                  "the solids, in a mesh editor");
  }
  return {};
}

std::vector<Vector3d> points_in_cavities(const SurfaceMesh& surface) {
  std::vector<Vector3d> points;
  const std::vector<std::vector<int>> shells = shells_of(surface);
  if (shells.size() < 2) return points;
  for (const std::vector<int>& shell : shells) {
    if (enclosed_volume(surface_of(surface, shell)) < 0.0) {
      points.push_back(point_before(surface, shell));
    }
  }
  return points;
}

}  // namespace palpable
