#include "palpable/common/geometry/surface_distance.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/nth_element.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

namespace palpable {

using Eigen::Vector3d;

namespace {

constexpr int kMostInALeaf = 4;  // triangles
// A smaller weight counts as 0: the nearest point lies on the opposite edge.
constexpr double kNoWeight = 1e-9;

// @returns t in 0 .. 1 of the point a + t (b - a) nearest to x
double along_edge(const Vector3d& a, const Vector3d& b, const Vector3d& x) {
  const Vector3d ab = b - a;
  const double length2 = ab.squaredNorm();
  return length2 > 0.0 ? std::clamp(ab.dot(x - a) / length2, 0.0, 1.0) : 0.0;
}

}  // namespace

Vector3d nearest_weights(const Vector3d& a, const Vector3d& b, const Vector3d& c,
                         const Vector3d& x) {
  const Vector3d ab = b - a, ac = c - a, ax = x - a;
  // The foot of the perpendicular from x, if it lies in the triangle.
  const double d00 = ab.dot(ab), d01 = ab.dot(ac), d11 = ac.dot(ac);
  const double d20 = ax.dot(ab), d21 = ax.dot(ac);
  const double area2 = d00 * d11 - d01 * d01;
  if (area2 > 0.0) {
    const double v = (d11 * d20 - d01 * d21) / area2;
    const double w = (d00 * d21 - d01 * d20) / area2;
    if (v >= 0.0 && w >= 0.0 && v + w <= 1.0) return {1.0 - v - w, v, w};
  }
  // Else the nearest of the points on its edges.
  const std::array<Vector3d, 3> corner{a, b, c};
  Vector3d best = Vector3d::UnitX();
  double nearest = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const double t = along_edge(corner[k], corner[next], x);
    const double distance = (x - corner[k] - t * (corner[next] - corner[k])).squaredNorm();
    if (distance >= nearest) continue;
    nearest = distance;
    best.setZero();
    best[k] = 1.0 - t;
    best[next] += t;
  }
  return best;
}

SurfaceDistance::SurfaceDistance(SurfaceMesh surface) : surface_(std::move(surface)) {
  const int M = surface_.triangle_count();
  PALPABLE_EXPECT(M > 0, "a surface with triangles");
  order_.resize(M);
  std::iota(order_.begin(), order_.end(), 0);
  std::vector<Vector3d> centres(M);
  for (int t = 0; t < M; ++t) {
    centres[t] = surface_.vertices(Eigen::all, surface_.triangles.col(t)).rowwise().mean();
  }
  build(0, M, centres);
  find_normals();
}

int SurfaceDistance::build(int first, int count, const std::vector<Vector3d>& centres) {
  const int number = static_cast<int>(boxes_.size());
  boxes_.push_back({{}, first, count});
  Eigen::AlignedBox3d bounds, of_centres;
  for (int i = first; i < first + count; ++i) {
    of_centres.extend(centres[order_[i]]);
    for (const int v : surface_.triangles.col(order_[i])) bounds.extend(surface_.vertices.col(v));
  }
  boxes_[number].bounds = bounds;
  if (count <= kMostInALeaf) return number;
  int axis = 0;
  of_centres.sizes().maxCoeff(&axis);
  const int half = count / 2;
  select_nth(order_.begin() + first, order_.begin() + first + half, order_.begin() + first + count,
             [&](int a, int b) { return centres[a][axis] < centres[b][axis]; });
  boxes_[number].count = 0;
  build(first, half, centres);
  const int second_half = build(first + half, count - half, centres);
  boxes_[number].second_half = second_half;
  return number;
}

void SurfaceDistance::find_normals() {
  const int M = surface_.triangle_count();
  face_normals_.setZero(3, M);
  edge_normals_.setZero(3, 3 * M);
  corner_normals_.setZero(3, surface_.vertex_count());
  std::map<std::pair<int, int>, Vector3d> edges;
  const auto edge = [&](int t, int k) {
    return std::minmax(surface_.triangles(k, t), surface_.triangles((k + 1) % 3, t));
  };
  for (int t = 0; t < M; ++t) {
    const auto corners = surface_.triangles.col(t);
    const auto at = [&](int k) -> Vector3d { return surface_.vertices.col(corners[k % 3]); };
    face_normals_.col(t) = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
    for (int k = 0; k < 3; ++k) {
      const Vector3d before = (at(k + 2) - at(k)).normalized();
      const Vector3d after = (at(k + 1) - at(k)).normalized();
      const double angle = std::acos(std::clamp(before.dot(after), -1.0, 1.0));
      corner_normals_.col(corners[k]) += angle * face_normals_.col(t);
      edges.try_emplace(edge(t, k), Vector3d::Zero()).first->second += face_normals_.col(t);
    }
  }
  for (int t = 0; t < M; ++t) {
    for (int k = 0; k < 3; ++k) edge_normals_.col(3 * t + k) = edges.at(edge(t, k)).normalized();
  }
  corner_normals_.colwise().normalize();
}

void SurfaceDistance::look_into(int box, Search& search) const {
  const Box& here = boxes_[box];
  const Vector3d& x = search.x;
  for (int i = here.first; i < here.first + here.count; ++i) {
    const int t = order_[i];
    if (search.facing.dot(face_normals_.col(t)) < search.least_facing) continue;
    const auto corners = surface_.triangles.col(t);
    const Vector3d weights =
        nearest_weights(surface_.vertices.col(corners[0]), surface_.vertices.col(corners[1]),
                        surface_.vertices.col(corners[2]), x);
    const Vector3d point = surface_.vertices(Eigen::all, corners) * weights;
    const double distance = (x - point).squaredNorm();
    if (distance >= search.best) continue;
    search.best = distance;
    search.found.point = point;
    search.found.triangle = t;
    search.found.weights = weights;
  }
  if (here.count > 0) return;
  int halves[2] = {box + 1, here.second_half};
  double far[2];
  for (int k = 0; k < 2; ++k) far[k] = boxes_[halves[k]].bounds.squaredExteriorDistance(x);
  if (far[1] < far[0]) {
    std::swap(far[0], far[1]);
    std::swap(halves[0], halves[1]);
  }
  for (int k = 0; k < 2; ++k) {
    if (far[k] < search.best) look_into(halves[k], search);
  }
}

Vector3d SurfaceDistance::normal_at(const NearestOnSurface& found) const {
  const auto corners = surface_.triangles.col(found.triangle);
  for (int k = 0; k < 3; ++k) {
    if (found.weights[k] > 1.0 - kNoWeight) return corner_normals_.col(corners[k]);
  }
  for (int k = 0; k < 3; ++k) {
    if (found.weights[(k + 2) % 3] < kNoWeight) return edge_normals_.col(3 * found.triangle + k);
  }
  return face_normals_.col(found.triangle);
}

NearestOnSurface SurfaceDistance::nearest(const Vector3d& x) const {
  return nearest_facing(x, Vector3d::Zero());
}

NearestOnSurface SurfaceDistance::nearest_facing(const Vector3d& x, const Vector3d& normal,
                                                 double least_cosine) const {
  Search search{
      x, normal, least_cosine * normal.norm(), std::numeric_limits<double>::infinity(), {}};
  look_into(0, search);
  return search.found.triangle < 0 ? nearest(x) : completed(search);
}

NearestOnSurface SurfaceDistance::completed(const Search& search) const {
  NearestOnSurface found = search.found;
  const Vector3d across = search.x - found.point;
  const Vector3d normal = normal_at(found);
  const double length = std::sqrt(search.best);
  const bool outside = normal.dot(across) >= 0.0;
  found.distance = outside ? length : -length;
  // Very close to the surface the direction to the nearest point would be rounding.
  const double scale = boxes_[0].bounds.diagonal().norm();
  found.normal = length > 1e-9 * scale ? Vector3d(across / found.distance) : normal;
  return found;
}

}  // namespace palpable
