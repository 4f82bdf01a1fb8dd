/// @file
/// Meshes a description's shape with tetrahedra in the body frame, and finds the nodes that its
/// supports hold.
#pragma once

#include "palpable/bake/describe/body_description.h"
#include "palpable/bake/mesh/tetrahedralise.h"
#include "palpable/bake/mesh/volume_mesh.h"
#include "palpable/bake/solid/solid_model.h"
#include "palpable/common/geometry/tet_mesh.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

/// A body ready to be solved. Body frame: m, Z up, standing on Z = 0, the middle of its bounding
/// box above the origin.
struct BodyMesh {
  TetMesh mesh;
  MeshSets sets;                  ///< of the file; empty where the shape is a surface
  Boundary boundary;              ///< of mesh, with all nodes of the skin: split_boundary_of()
  std::vector<int> fixed_nodes;   ///< increasing: held in all directions, not displaced
  std::vector<Support> supports;  ///< all other held nodes, each once
  double height = 0;              ///< m
  TetQuality quality;
  std::string origin;  ///< one line for people: source, sizes, how it was made
};

/// Rotates `up` to Z (a cyclic permutation of the axes, so nothing is mirrored), scales to `height`
/// if there is one, and puts the points on Z = 0 with the middle of their bounding box above the
/// origin.
/// @throws ContractViolation for no points or height <= 0; Error for points all at one height
void place_in_body_frame(Eigen::Matrix3Xd& points, UpAxis up, std::optional<double> height);

/// Extents of the body before it is meshed, m, along the axes of the body frame. Reads the shape's
/// file.
/// @param repair  if given: what is repaired of it, one line with its figures; empty: nothing
/// @throws Error for what cannot be read or placed
[[nodiscard]] Eigen::Vector3d size_of_body(const BodyDescription& description,
                                           std::string* repair = nullptr);

/// Whether the body's tetrahedra have ten nodes. Reads the file of a volume whose order is not
/// given. @throws Error for what cannot be read
[[nodiscard]] bool is_of_ten_nodes(const BodyDescription::Shape& shape);

/// A warning, beginning with file and line, about a shape whose cavities its wrap would fill;
/// nothing for other shapes, nor for a surface that is not closed and therefore has no cavities.
/// Reads the file.
[[nodiscard]] std::optional<std::string> wrap_warning(const BodyDescription::Shape& shape);

/// The skin of a volume with all nodes on it: where tetrahedra have ten nodes, each face is four
/// triangles between its corners and the middles of its edges.
[[nodiscard]] Boundary split_boundary_of(const TetMesh& mesh);

/// Reads the shape's file, places it, meshes it, finds what the supports hold.
/// @throws Error for what cannot be read or meshed, for a body that is impossibly large or small
///         (body_size.h), and when a support holds no node or two
///         supports contradict each other
[[nodiscard]] BodyMesh make_body_mesh(const BodyDescription& description);

/// The same body with its skin remeshed and filled again. The new mesh has no sets, so a
/// description that refers to sets is refused.
/// @param skin  of the body, in the body frame
/// @param edge  m, on the skin and within
/// @throws Error as make_body_mesh()
[[nodiscard]] BodyMesh remeshed(const BodyDescription& description, const SurfaceMesh& skin,
                                double edge);

/// (N) 1 where the supports hold the node in all three directions, moved or not.
[[nodiscard]] std::vector<std::uint8_t> held_nodes(const BodyMesh& body);

}  // namespace palpable
