/// @file
/// Triangle surfaces: the skin of a body.
///
///   N  vertices     M  triangles
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <string>
#include <vector>

namespace palpable {

/// Vertices and triangles; triangles are counter-clockwise seen from outside.
struct SurfaceMesh {
  Eigen::Matrix3Xd vertices;   ///< (3 x N) m
  Eigen::Matrix3Xi triangles;  ///< (3 x M) vertex indices

  [[nodiscard]] int vertex_count() const { return static_cast<int>(vertices.cols()); }
  [[nodiscard]] int triangle_count() const { return static_cast<int>(triangles.cols()); }
};

/// Whether a surface encloses a solid, and if not, its defects.
struct WatertightReport {
  int open_edges = 0;       ///< edges of only one triangle: holes
  int crowded_edges = 0;    ///< edges of three or more triangles
  int flipped_edges = 0;    ///< edges whose two triangles have opposite orientations
  int bad_triangles = 0;    ///< with a repeated vertex, an index out of range, or no area
  bool inside_out = false;  ///< the enclosed volume is negative
  Eigen::Vector3d first_defect = Eigen::Vector3d::Zero();  ///< m, position of the first defect
  double apart = 0.0;  ///< m, told_apart() of the surface, for the digits of that position

  [[nodiscard]] bool watertight() const {
    return open_edges == 0 && crowded_edges == 0 && flipped_edges == 0 && bad_triangles == 0 &&
           !inside_out;
  }
  /// The defects, the position of the first and the remedy, in one line; "watertight" if there are
  /// none.
  [[nodiscard]] std::string describe() const;
};

/// Checks closedness, manifoldness and orientation. O(M log M). An empty surface is not watertight.
[[nodiscard]] WatertightReport check_watertight(const SurfaceMesh& surface);

/// Joins vertices that coincide exactly (STL repeats each corner) and drops unused ones.
[[nodiscard]] SurfaceMesh merge_equal_vertices(const SurfaceMesh& surface);

/// Signed enclosed volume in m^3 (divergence theorem); positive when oriented outwards.
[[nodiscard]] double enclosed_volume(const SurfaceMesh& surface);

/// Centre of mass of the enclosed homogeneous solid, m.
[[nodiscard]] Eigen::Vector3d enclosed_centroid(const SurfaceMesh& surface);

/// The smallest box around all vertices. @pre there are vertices
[[nodiscard]] Eigen::AlignedBox3d box_of(const SurfaceMesh& surface);

/// (N) a third of the area of the adjacent triangles, m^2.
[[nodiscard]] Eigen::VectorXd vertex_areas(const SurfaceMesh& surface);

/// Area-weighted unit normals at the vertices, outwards. Allocates nothing.
/// @param vertices  (3 x N) deformed or not
/// @param normals   (3 x N) overwritten; zero where no triangle with area meets the vertex
void vertex_normals(const Eigen::Matrix3Xf& vertices, const Eigen::Matrix3Xi& triangles,
                    Eigen::Matrix3Xf& normals);
void vertex_normals(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles,
                    Eigen::Matrix3Xd& normals);

/// Neighbours along edges, sorted: one list per vertex.
[[nodiscard]] std::vector<std::vector<int>> vertex_neighbours(const SurfaceMesh& surface);

/// Vertices within `graph_distance` edges of `vertex`, itself first, then by distance and number:
/// the contact patch of the paper (Fig. 15 uses 2).
[[nodiscard]] std::vector<int> graph_patch(const std::vector<std::vector<int>>& neighbours,
                                           int vertex, int graph_distance);

/// Closed box, corners a < b; six faces, outward orientation. For tests and examples.
[[nodiscard]] SurfaceMesh box_surface(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

/// Closed sphere from a subdivided icosahedron (20 * 4^n triangles). For tests and examples.
[[nodiscard]] SurfaceMesh sphere_surface(const Eigen::Vector3d& centre, double radius,
                                         int subdivisions);

/// Mean length of the edges, m. @throws ContractViolation for a surface without triangles
[[nodiscard]] double mean_edge_length(const SurfaceMesh& surface);

}  // namespace palpable
