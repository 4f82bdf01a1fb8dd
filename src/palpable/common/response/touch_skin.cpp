#include "palpable/common/response/touch_skin.h"

#include "palpable/common/contact/point_levels.h"

#include <algorithm>

namespace palpable {

using Eigen::Matrix3Xf;

Carrier::Carrier(const SurfaceMesh& coarse) : surface_(coarse), normals_(3, coarse.vertex_count()) {
  vertex_normals(coarse.vertices, coarse.triangles, normals_);
}

CarriedPoint Carrier::stand(const Eigen::Vector3d& place, const Eigen::Vector3d& normal) const {
  const NearestOnSurface at = surface_.nearest_facing(place, normal);
  const auto corners = surface_.surface().triangles.col(at.triangle);
  CarriedPoint point;
  point.on.corners = {corners[0], corners[1], corners[2]};
  point.on.weights = at.weights.cast<float>();
  const Eigen::Vector3d along = (normals_(Eigen::all, corners) * at.weights).normalized();
  point.height = static_cast<float>(along.dot(place - at.point));
  return point;
}

TouchSkin::TouchSkin(const SurfaceMesh& skin, std::span<const std::uint8_t> fixed,
                     const TouchTables& tables)
    : rest_(skin.vertices.cast<float>()), skin_(rest_) {
  points_ = skin_points(skin, fixed, tables.point_spacing);
  levels_ = point_levels(skin, points_, kCoarsest, kFinest);
  places_ = places_of(points_, skin_);
  held_ = held_vertices(skin_, fixed);
  if (!tables.coarse) return;

  const SurfaceMesh& coarse = tables.coarse->surface;
  rest_ = coarse.vertices.cast<float>();
  coarse_triangles_ = coarse.triangles;
  normals_.resize(3, rest_.cols());
  vertex_normals(rest_, coarse_triangles_, normals_);
  moved_ = turn_ = Matrix3Xf::Zero(3, rest_.cols());

  const Carrier carrier(coarse);
  Eigen::Matrix3Xd normals(3, skin.vertex_count());
  vertex_normals(skin.vertices, skin.triangles, normals);
  carried_.reserve(static_cast<std::size_t>(skin.vertex_count()));
  for (int v = 0; v < skin.vertex_count(); ++v) {
    carried_.push_back(carrier.stand(skin.vertices.col(v), normals.col(v)));
  }
  const Matrix3Xf single_normals = normals.cast<float>();
  std::vector<Eigen::Vector3f> held;
  std::size_t kept = 0;
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const SkinPoint& point = points_[p];
    const auto column = static_cast<Eigen::Index>(p);
    const bool is_vertex = point.weights[0] == 1.0f;
    CarriedPoint carried = is_vertex ? carried_[static_cast<std::size_t>(point.corners[0])]
                                     : carrier.stand(places_.col(column).cast<double>(),
                                                     point.at(single_normals).cast<double>());
    const bool can_move =
        std::any_of(carried.on.corners.begin(), carried.on.corners.end(),
                    [&](int v) { return tables.coarse->fixed[static_cast<std::size_t>(v)] == 0; });
    if (!can_move) {
      held.emplace_back(places_.col(column));
      continue;
    }
    carried.on.area = point.area;
    points_[kept] = carried.on;
    levels_[kept] = levels_[p];
    places_.col(static_cast<Eigen::Index>(kept)) = places_.col(column);
    heights_.push_back(carried.height);
    ++kept;
  }
  points_.resize(kept);
  levels_.resize(kept);
  places_.conservativeResize(3, static_cast<Eigen::Index>(kept));
  const Eigen::Index before = held_.cols();
  held_.conservativeResize(3, before + std::ssize(held));
  for (std::size_t k = 0; k < held.size(); ++k) {
    held_.col(before + static_cast<Eigen::Index>(k)) = held[k];
  }
}

void TouchSkin::update_normals(const Matrix3Xf& u) {
  if (!is_carried()) return;
  if (u.cols() == 0) {
    turn_.setZero();
    return;
  }
  moved_ = rest_ + u.leftCols(rest_.cols());
  vertex_normals(moved_, coarse_triangles_, turn_);
  turn_ -= normals_;
}

ForceShares TouchSkin::shares_of(const SkinPoint& foot) const {
  ForceShares shares;
  const auto add = [&](int vertex, float weight) {
    if (weight > 0) shares.of[shares.count++] = {vertex, weight};
  };
  for (std::size_t k = 0; k < 3; ++k) {
    const float weight = foot.weights[static_cast<int>(k)];
    if (!is_carried()) {
      add(foot.corners[k], weight);
      continue;
    }
    const SkinPoint& on = carried_[static_cast<std::size_t>(foot.corners[k])].on;
    for (std::size_t c = 0; c < 3; ++c) {
      add(on.corners[c], weight * on.weights[static_cast<int>(c)]);
    }
  }
  return shares;
}

void TouchSkin::place(const Matrix3Xf& u, Matrix3Xf& skin) const {
  if (u.cols() == 0) {
    skin = skin_;
  } else if (!is_carried()) {
    skin = rest_ + u.leftCols(rest_.cols());
  } else {
    for (Eigen::Index v = 0; v < skin_.cols(); ++v) {
      skin.col(v) = skin_.col(v) + carried_[static_cast<std::size_t>(v)].moved(u, turn_);
    }
  }
}

void TouchSkin::spread(std::span<const float> of_vertices, std::size_t width,
                       std::span<float> skin) const {
  if (!is_carried()) {
    std::copy(of_vertices.begin(), of_vertices.end(), skin.begin());
    return;
  }
  std::size_t to = 0;
  for (const CarriedPoint& point : carried_) {
    const auto& [corners, weights, area] = point.on;
    for (std::size_t c = 0; c < width; ++c) {
      float sum = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        sum += weights[static_cast<Eigen::Index>(k)] *
               of_vertices[width * static_cast<std::size_t>(corners[k]) + c];
      }
      skin[to++] = sum;
    }
  }
}

}  // namespace palpable
