/// @file
/// The skin that is touched, and its contact points as weighted sums of the vertices that the
/// tables know. These are the skin's own vertices, or those of a coarser skin that carries it
/// (Carrier).
///
///   V  vertices of the tables     F  vertices of the body's skin; V if it is not carried
///   C  contact points, of the body's skin     W >= V  columns of displacements
#pragma once

#include "palpable/common/geometry/skin_points.h"
#include "palpable/common/geometry/surface_distance.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/response/touch_tables.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace palpable {

// A fine skin that a coarser one carries: each point of the fine skin is attached to a triangle of
// the coarse skin and keeps its height over that triangle.
//
//     x = X + sum_k w_k u_k + h sum_k w_k (n_k - N_k)
//
// with X the point at rest, h its height along the interpolated normal, and of the triangle's
// corners k the weights w, displacements u and vertex normals n (N at rest). The map is continuous
// wherever the coarse skin is, and x = X while the coarse skin is at rest. A rotation R of the
// coarse skin is reproduced except for (R - 1) d, with d the part of X's offset from the triangle
// that differs from h sum_k w_k N_k.
//
//   V  vertices of the coarse skin

/// The triangle of the coarse skin that a point of the fine skin is attached to.
struct CarriedPoint {
  SkinPoint on;      ///< position on the coarse skin; its area is not set
  float height = 0;  ///< m, over that position

  /// The point's displacement, m.
  /// @param u     (3 x V or more columns) m, displacement of the coarse skin
  /// @param turn  (3 x V) n - N, by how much the coarse skin's vertex normals have turned
  [[nodiscard]] Eigen::Vector3f moved(const Eigen::Matrix3Xf& u,
                                      const Eigen::Matrix3Xf& turn) const {
    return on.at(u) + height * on.at(turn);
  }
};

/// A coarse skin at rest, to which points are attached.
class Carrier {
 public:
  explicit Carrier(const SurfaceMesh& coarse);

  /// Attaches a point to the nearest triangle whose normal agrees with the point's normal.
  /// @param place   m, position on the fine skin at rest
  /// @param normal  of the fine skin at that position
  [[nodiscard]] CarriedPoint stand(const Eigen::Vector3d& place,
                                   const Eigen::Vector3d& normal) const;

 private:
  SurfaceDistance surface_;
  Eigen::Matrix3Xd normals_;  // (3 x V)
};

/// A vertex of the tables, and the share of a force on the body's skin that acts on it.
struct ForceShare {
  int vertex = 0;
  float weight = 0;
};
/// The shares of one place: of three corners, or of three corners for each corner of a carried
/// skin.
struct ForceShares {
  std::array<ForceShare, 9> of{};
  std::size_t count = 0;
};

class TouchSkin {
 public:
  /// m between contact points that the flattest and the sharpest obstacle need (point_levels.h).
  static constexpr double kCoarsest = 0.006, kFinest = 0.0015;

  /// @param skin   (F vertices) the body's, at rest
  /// @param fixed  (F) 1 where the support holds the vertex
  /// @pre trouble_of(tables, skin) is empty
  TouchSkin(const SurfaceMesh& skin, std::span<const std::uint8_t> fixed,
            const TouchTables& tables);

  [[nodiscard]] const Eigen::Matrix3Xf& rest() const { return rest_; }  ///< (3 x V) m
  /// (C) on the V vertices. Points that cannot be displaced are left out.
  [[nodiscard]] std::span<const SkinPoint> points() const { return points_; }
  [[nodiscard]] const Eigen::Matrix3Xf& places() const { return places_; }  ///< (3 x C) m, at rest
  [[nodiscard]] std::span<const float> levels() const { return levels_; }   ///< (C) point_levels()
  /// (3 x H) m, at rest: vertices of the body's skin that the support holds, and points of it that
  /// cannot be displaced.
  [[nodiscard]] const Eigen::Matrix3Xf& held() const { return held_; }

  /// Computes the vertex normals of the coarser skin for this displacement, (3 x W) m, or with no
  /// columns for the skin at rest. The functions below use them. Does nothing for a skin that is
  /// not carried.
  void update_normals(const Eigen::Matrix3Xf& u);
  /// The part of a point's displacement that the turning of its height over the coarser skin adds,
  /// m.
  [[nodiscard]] Eigen::Vector3f lift_of(std::size_t point) const {
    if (heights_.empty()) return Eigen::Vector3f::Zero();
    return heights_[point] * points_[point].at(turn_);
  }
  /// The displacement of a contact point by a displacement u of the vertices, m.
  [[nodiscard]] Eigen::Vector3f moved(std::size_t point, const Eigen::Matrix3Xf& u) const {
    return points_[point].at(u) + lift_of(point);
  }

  /// The vertices of the tables that a force at a place of the body's skin acts on.
  [[nodiscard]] ForceShares shares_of(const SkinPoint& foot) const;
  /// Position at rest, m.
  [[nodiscard]] Eigen::Vector3f rest_at(const SkinPoint& foot) const { return foot.at(skin_); }

  /// Positions of the body's skin, (3 x F) m. @param u  (3 x W) m, as given to update_normals()
  void place(const Eigen::Matrix3Xf& u, Eigen::Matrix3Xf& skin) const;
  /// Interpolates a quantity from the V vertices to those of the body's skin. @param width  numbers
  /// per vertex
  void spread(std::span<const float> of_vertices, std::size_t width, std::span<float> skin) const;
  [[nodiscard]] bool is_carried() const { return coarse_triangles_.cols() > 0; }

 private:
  Eigen::Matrix3Xf rest_, skin_;       // (3 x V), (3 x F) m
  Eigen::Matrix3Xi coarse_triangles_;  // none: not carried
  Eigen::Matrix3Xf normals_;           // (3 x V) at rest
  Eigen::Matrix3Xf moved_, turn_;      // (3 x V) m, positions, and normals less those at rest
  std::vector<CarriedPoint> carried_;  // (F) the vertices; none: not carried
  std::vector<SkinPoint> points_;
  std::vector<float> levels_, heights_;
  Eigen::Matrix3Xf places_;
  Eigen::Matrix3Xf held_;  // (3 x H) m
};

}  // namespace palpable
