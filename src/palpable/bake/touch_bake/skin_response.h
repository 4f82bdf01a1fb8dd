/// @file
/// The response of a body to loads on its skin, with rows numbered by the skin's vertices. The
/// makers of the touch tables are built on it.
///
///   N  nodes of the mesh     V  vertices of the skin     k  loads
///   W  nodes of the shell, whose displacement determines the stress on the skin: those of the
///      skin, then inner ones (response/shell_table.h)
#pragma once

#include "palpable/bake/solid/load_response.h"
#include "palpable/bake/solid/stress_recovery.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/geometry/tet_mesh.h"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace palpable {

class SkinResponse {
 public:
  /// @param boundary   boundary_of(model.mesh)
  /// @param preloaded  loads that act already, such as weight; nullptr: none
  /// @throws Error as LoadResponse
  SkinResponse(const SolidModel& model, Boundary boundary, const Preloaded* preloaded = nullptr);

  [[nodiscard]] const LoadResponse& body() const { return response_; }
  /// The skin in the preloaded state, in which presses begin.
  [[nodiscard]] const SurfaceMesh& skin() const { return skin_; }
  [[nodiscard]] const Eigen::Matrix3Xd& normals() const { return normals_; }  ///< (3 x V) unit
  /// (V) 1 where the support holds the vertex in all directions.
  [[nodiscard]] const std::vector<std::uint8_t>& fixed() const { return fixed_; }
  [[nodiscard]] int vertex_count() const { return skin_.vertex_count(); }
  [[nodiscard]] int node_of(int vertex) const { return boundary_.node_of_vertex[vertex]; }

  /// (3N x k) nodal forces from forces at the skin's vertices; 0 in held directions.
  /// @param loads  (3V x k) N
  [[nodiscard]] Eigen::MatrixXd at_nodes(const Eigen::MatrixXd& loads) const;
  /// (3V x k) the skin's rows of nodal fields (3N x k).
  [[nodiscard]] Eigen::MatrixXd on_skin(const Eigen::MatrixXd& fields) const;
  /// (3W x k) the shell's rows of nodal fields, the skin's first.
  [[nodiscard]] Eigen::MatrixXd in_shell(const Eigen::MatrixXd& fields) const;

  [[nodiscard]] const StressRecovery& recovery() const { return recovery_; }
  /// (W) the shell's nodes as numbers in the mesh, the skin's first.
  [[nodiscard]] const std::vector<int>& shell_nodes() const { return shell_nodes_; }
  /// The shell's elements as numbers in the mesh, rising.
  [[nodiscard]] const std::vector<int>& shell_elements() const { return shell_elements_; }
  [[nodiscard]] int shell_count() const { return static_cast<int>(shell_nodes_.size()); }  ///< W

  /// m, between two vertices; 30 mm are added if their normals point in opposite directions, so
  /// that the two sides of an ear do not count as neighbours.
  [[nodiscard]] double distance(int a, int b) const;
  /// Unit, outwards: the mean normal of the skin within `radius` (m) of a vertex.
  [[nodiscard]] Eigen::Vector3d mean_normal(int vertex, double radius) const;

 private:
  Boundary boundary_;
  LoadResponse response_;
  SurfaceMesh skin_;
  Eigen::Matrix3Xd normals_;
  std::vector<std::uint8_t> fixed_;
  StressRecovery recovery_;
  std::vector<int> shell_nodes_, shell_elements_;
};

/// Vertices spread over the skin by farthest-point sampling: each next one is the vertex that is
/// farthest from all chosen before and not held, until none is farther than `spacing` (m) or `most`
/// are chosen.
[[nodiscard]] std::vector<int> spread_vertices(const SkinResponse& skin, double spacing, int most);

}  // namespace palpable
