/// @file
/// From a description's shape to tetrahedra in the body frame.
#pragma once

#include "palpable/bake/body_description.h"
#include "palpable/bake/tetrahedralise.h"
#include "palpable/geometry/tet_mesh.h"

#include <cstdint>
#include <string>
#include <vector>

namespace palpable {

/// A body ready to be solved. Body frame: m, Z up, standing on Z = 0, the middle of its bounding
/// box above the origin.
struct BodyMesh {
  TetMesh mesh;
  Boundary boundary;             ///< of mesh
  std::vector<int> fixed_nodes;  ///< of mesh, increasing: those the support holds
  double height = 0;             ///< m
  TetQuality quality;
  std::string origin;  ///< one line for people: source, sizes, how it was made
};

/// Turns `up` to Z (x to y to z cyclically, so nothing is mirrored), scales to `height` if there is
/// one, and puts the points on Z = 0 with the middle of their bounding box above the origin.
/// @throws ContractViolation for no points or height <= 0; Error for points all at one height
void place_in_body_frame(Eigen::Matrix3Xd& points, UpAxis up, std::optional<double> height);

/// Reads the shape's file, places it, meshes it, finds what the support holds.
/// @throws Error for what cannot be read or meshed, or when the support holds no node
[[nodiscard]] BodyMesh make_body_mesh(const BodyDescription& description);

}  // namespace palpable
