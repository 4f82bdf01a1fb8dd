/// @file
/// Runs TetGen in a child process, because it may crash: on some surfaces directly, on others in
/// its destructor after it has given up.
#pragma once

#include "palpable/common/geometry/tet_mesh.h"

#include <Eigen/Core>

#include <string>
#include <variant>
#include <vector>

namespace palpable {

struct TetgenRequest {
  const SurfaceMesh& surface;
  double largest_volume;                    ///< m^3, of a tetrahedron; > 0
  std::vector<Eigen::Vector3d> holes = {};  ///< a point in each cavity
};

/// Keeps the surface triangle for triangle ("Y") and adds nodes inside until radius to edge ratios
/// are below 1.3 and dihedral angles above 12 degrees, where the surface allows it ("q"), and
/// volumes below the largest ("a").
/// @returns nodes and tetrahedra in TetGen's order; or the reason why there are none, for the user
/// @throws Error when no process can be started
[[nodiscard]] std::variant<TetMesh, std::string> run_tetgen(const TetgenRequest& request);

}  // namespace palpable
