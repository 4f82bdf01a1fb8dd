/// @file
/// The skin that is touched: its contact points, by the vertices that the tables know. These are
/// its own, or those of a coarser skin that carries it (carried_skin.h).
///
///   V  vertices that the tables know     F  of the body's skin; the same, if it is not carried
///   C  contact points, of the body's skin     W >= V  columns of displacements
#pragma once

#include "palpable/common/geometry/skin_points.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/response/carried_skin.h"
#include "palpable/common/response/touch_tables.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace palpable {

/// A share of a force on the body's skin: a vertex that the tables know, and how much of it.
struct ForceShare {
  int vertex = 0;
  float weight = 0;
};
/// Those of one place: three corners, or three for each corner of a skin that is carried.
struct ForceShares {
  std::array<ForceShare, 9> of{};
  std::size_t count = 0;
};

class TouchSkin {
 public:
  /// m between contact points: on the flattest of objects, and the least that is told apart.
  static constexpr double kCoarsest = 0.006, kFinest = 0.0015;

  /// @param skin   (F vertices) the body's, at rest
  /// @param fixed  (F) 1 where the support holds the vertex
  /// @pre trouble_of(tables, skin) is empty
  TouchSkin(const SurfaceMesh& skin, std::span<const std::uint8_t> fixed,
            const TouchTables& tables);

  [[nodiscard]] const Eigen::Matrix3Xf& rest() const { return rest_; }  ///< (3 x V) m
  /// (C) on the V vertices. Points that cannot give way are left out.
  [[nodiscard]] std::span<const SkinPoint> points() const { return points_; }
  [[nodiscard]] const Eigen::Matrix3Xf& places() const { return places_; }  ///< (3 x C) m, at rest
  [[nodiscard]] std::span<const float> levels() const { return levels_; }   ///< (C) point_levels()

  /// The way in which vertices face, from here on: as in this displacement, (3 x W) m, or, with no
  /// columns, at rest. A skin that is not carried does not ask.
  void face_as(const Eigen::Matrix3Xf& u);
  /// What the heights over the coarser skin add to a point's displacement by its corners, m.
  [[nodiscard]] Eigen::Vector3f lifted(std::size_t point) const {
    if (heights_.empty()) return Eigen::Vector3f::Zero();
    return heights_[point] * points_[point].at(turn_);
  }
  /// How far a point moves by a displacement of the vertices, m.
  [[nodiscard]] Eigen::Vector3f moved(std::size_t point, const Eigen::Matrix3Xf& u) const {
    return points_[point].at(u) + lifted(point);
  }

  /// Which vertices of the tables a force at a place of the body's skin acts on.
  [[nodiscard]] ForceShares shares_of(const SkinPoint& foot) const;
  /// m, at rest.
  [[nodiscard]] Eigen::Vector3f rest_at(const SkinPoint& foot) const { return foot.at(skin_); }

  /// (3 x F) m: where the body's skin is by a displacement as face_as() has got it.
  void place(const Eigen::Matrix3Xf& u, Eigen::Matrix3Xf& skin) const;
  /// A quantity of the V vertices at those of the body's skin. @param width  numbers of each vertex
  void spread(std::span<const float> of_vertices, std::size_t width, std::span<float> skin) const;
  [[nodiscard]] bool is_carried() const { return coarse_triangles_.cols() > 0; }

 private:
  Eigen::Matrix3Xf rest_, skin_;       // (3 x V), (3 x F) m
  Eigen::Matrix3Xi coarse_triangles_;  // none: not carried
  Eigen::Matrix3Xf normals_;           // (3 x V) at rest
  Eigen::Matrix3Xf moved_, turn_;  // (3 x V) m, of face_as(), and its normals less those at rest
  std::vector<CarriedPoint> carried_;  // (F) the vertices; none: not carried
  std::vector<SkinPoint> points_;
  std::vector<float> levels_, heights_;
  Eigen::Matrix3Xf places_;
};

}  // namespace palpable
