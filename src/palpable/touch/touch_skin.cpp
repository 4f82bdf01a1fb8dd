#include "palpable/touch/touch_skin.h"

#include "palpable/touch/point_levels.h"

#include <algorithm>

namespace palpable {

TouchSkin::TouchSkin(const SurfaceMesh& skin, std::span<const std::uint8_t> fixed,
                     const TouchTables& tables)
    : rest_(skin.vertices.cast<float>()), skin_(rest_) {
  points_ = skin_points(skin, fixed, tables.point_spacing);
  levels_ = point_levels(skin, points_, kCoarsest, kFinest);
  places_.resize(3, static_cast<Eigen::Index>(points_.size()));
  for (std::size_t p = 0; p < points_.size(); ++p) {
    places_.col(static_cast<Eigen::Index>(p)) = points_[p].at(skin_);
  }
  if (!tables.coarse) return;

  const SurfaceMesh& coarse = tables.coarse->surface;
  rest_ = coarse.vertices.cast<float>();
  coarse_triangles_ = coarse.triangles;
  normals_.resize(3, rest_.cols());
  vertex_normals(rest_, coarse_triangles_, normals_);
  turn_.setZero(3, rest_.cols());
  moved_ = faced_ = turn_;
  Eigen::Matrix3Xd normals(3, skin.vertex_count());
  vertex_normals(skin.vertices, skin.triangles, normals);
  carried_ = CarriedSkin(coarse, skin.vertices, normals);

  const Eigen::Matrix3Xf normals_of_skin = normals.cast<float>();
  Eigen::Matrix3Xd of_points(3, places_.cols());
  for (std::size_t p = 0; p < points_.size(); ++p) {
    of_points.col(static_cast<Eigen::Index>(p)) =
        points_[p].at(normals_of_skin).cast<double>().normalized();
  }
  const CarriedSkin carried(coarse, places_.cast<double>(), of_points);
  std::size_t kept = 0;
  for (std::size_t p = 0; p < points_.size(); ++p) {
    SkinPoint on = carried.points()[p].on;
    const bool gives_way = std::any_of(on.corners.begin(), on.corners.end(), [&](int v) {
      return tables.coarse->fixed[static_cast<std::size_t>(v)] == 0;
    });
    if (!gives_way) continue;
    on.area = points_[p].area;
    points_[kept] = on;
    levels_[kept] = levels_[p];
    places_.col(static_cast<Eigen::Index>(kept)) = places_.col(static_cast<Eigen::Index>(p));
    heights_.push_back(carried.points()[p].height);
    ++kept;
  }
  points_.resize(kept);
  levels_.resize(kept);
  places_.conservativeResize(3, static_cast<Eigen::Index>(kept));
}

void TouchSkin::face_as(const Eigen::Matrix3Xf& u) {
  if (!is_carried()) return;
  if (u.cols() == 0) {
    turn_.setZero();
    return;
  }
  moved_ = rest_ + u.leftCols(rest_.cols());
  vertex_normals(moved_, coarse_triangles_, faced_);
  turn_ = faced_ - normals_;
}

void TouchSkin::place(const Eigen::Matrix3Xf& u, Eigen::Matrix3Xf& skin) const {
  if (u.cols() == 0) {
    skin = skin_;
  } else if (!is_carried()) {
    skin = rest_ + u.leftCols(rest_.cols());
  } else {
    for (Eigen::Index v = 0; v < skin_.cols(); ++v) {
      skin.col(v) = skin_.col(v) + carried_.moved(static_cast<std::size_t>(v), u, turn_);
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
  for (const CarriedPoint& point : carried_.points()) {
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
