/// @file
/// A body's answer to loads on its skin, by the skin's own numbers: what the tables of touch are
/// made of.
///
///   N  nodes of the mesh     V  vertices of the skin     k  loads
///   W  nodes of the shell, from whose displacement the stress on the skin follows: those of the
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
  /// @param preloaded  what acts already; nullptr: nothing
  /// @throws Error as LoadResponse
  SkinResponse(const SolidModel& model, Boundary boundary, const Preloaded* preloaded = nullptr);

  [[nodiscard]] const LoadResponse& body() const { return response_; }
  /// The skin in the body's state: where presses begin.
  [[nodiscard]] const SurfaceMesh& skin() const { return skin_; }
  [[nodiscard]] const Eigen::Matrix3Xd& normals() const { return normals_; }  ///< (3 x V) unit
  /// (V) 1 where the support holds the vertex in all directions.
  [[nodiscard]] const std::vector<std::uint8_t>& fixed() const { return fixed_; }
  [[nodiscard]] int vertex_count() const { return skin_.vertex_count(); }
  [[nodiscard]] int node_of(int vertex) const { return boundary_.node_of_vertex[vertex]; }

  /// (3N x k) forces at the nodes from those at the skin's vertices, 0 in held directions.
  /// @param loads  (3V x k) N
  [[nodiscard]] Eigen::MatrixXd at_nodes(const Eigen::MatrixXd& loads) const;
  /// (3V x k) the skin's rows of fields of nodes.
  [[nodiscard]] Eigen::MatrixXd on_skin(const Eigen::MatrixXd& fields) const;
  /// (3W x k) the shell's rows, the skin's first.
  [[nodiscard]] Eigen::MatrixXd in_shell(const Eigen::MatrixXd& fields) const;

  [[nodiscard]] const StressRecovery& recovery() const { return recovery_; }
  /// (W) nodes of the mesh.
  [[nodiscard]] const std::vector<int>& shell_nodes() const { return shell_nodes_; }
  /// Elements of the mesh, rising.
  [[nodiscard]] const std::vector<int>& shell_elements() const { return shell_elements_; }
  [[nodiscard]] int shell_count() const { return static_cast<int>(shell_nodes_.size()); }  ///< W

  /// m: between two vertices, longer by 30 mm where their normals point apart, so that the two
  /// sides of an ear are no neighbours.
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

/// Vertices far from each other: the next one is always the farthest from all before, among those
/// that are not held, until none is farther than `spacing` or there are `most`.
[[nodiscard]] std::vector<int> spread_vertices(const SkinResponse& skin, double spacing, int most);

}  // namespace palpable
