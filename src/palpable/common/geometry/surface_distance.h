/// @file
/// Distance to a closed triangle surface: nearest point, sign, normal.
///
/// Metres; the frame is the caller's.
#pragma once

#include "palpable/common/geometry/surface_mesh.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <vector>

namespace palpable {

/// The point of a surface that is nearest to a given point.
struct NearestOnSurface {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    ///< m, on the surface
  int triangle = -1;                                  ///< on which it lies
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();  ///< of the triangle's corners, sum 1
  double distance = 0;                                ///< m, negative inside
  /// Gradient of the distance, a unit vector that points outwards. On the surface itself, the
  /// normal of the face, or the mean normal of the edge or corner.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
};

/// Finds nearest points by a tree of boxes over the triangles: O(log M) for each query.
///
/// The sign is that of the angle-weighted normal of the nearest face, edge or corner (Baerentzen
/// and Aanaes, "Signed distance computation using the angle weighted pseudonormal", 2005), which is
/// right everywhere around a closed surface.
class SurfaceDistance {
 public:
  /// @param surface  at least one triangle. If it is not watertight (check_watertight()), the sign
  /// is
  ///                 meaningless; the nearest point is still right
  explicit SurfaceDistance(SurfaceMesh surface);

  [[nodiscard]] const SurfaceMesh& surface() const { return surface_; }
  [[nodiscard]] NearestOnSurface nearest(const Eigen::Vector3d& x) const;
  /// The same among triangles whose normals are within 90 degrees of `normal`, which selects one
  /// side of a thin part. If there are none, all triangles are considered.
  /// @param least_cosine  of the angle between a triangle's normal and `normal`; a value above 0
  ///                      also leaves out triangles perpendicular to it
  [[nodiscard]] NearestOnSurface nearest_facing(const Eigen::Vector3d& x,
                                                const Eigen::Vector3d& normal,
                                                double least_cosine = 0) const;

 private:
  struct Box {
    Eigen::AlignedBox3d bounds;
    int first, count;     // triangles order_[first .. first + count - 1]; an inner box has none
    int second_half = 0;  // number of the second child; the first is the next box
  };
  int build(int first, int count, const std::vector<Eigen::Vector3d>& centres);
  // A query and the nearest point found so far.
  struct Search {
    Eigen::Vector3d x, facing;  // the position; the direction that triangles have to face, 0: any
    double least_facing;        // least value of facing . normal
    double best;                // m^2, squared distance
    NearestOnSurface found;
  };
  void look_into(int box, Search& search) const;
  [[nodiscard]] NearestOnSurface completed(const Search& search) const;
  void find_normals();
  [[nodiscard]] Eigen::Vector3d normal_at(const NearestOnSurface& found) const;

  SurfaceMesh surface_;
  std::vector<int> order_;
  std::vector<Box> boxes_;
  Eigen::Matrix3Xd face_normals_, corner_normals_;
  Eigen::Matrix3Xd
      edge_normals_;  // (3 x 3 M): edge k of triangle t, corners k and k + 1, at 3t + k
};

/// The point of a triangle that is nearest to x, as weights of its corners a, b, c.
[[nodiscard]] Eigen::Vector3d nearest_weights(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                              const Eigen::Vector3d& c, const Eigen::Vector3d& x);

}  // namespace palpable
