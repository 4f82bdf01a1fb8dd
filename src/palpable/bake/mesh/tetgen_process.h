/// @file
/// TetGen in a process of its own. Where it gives up, it leaves what its destructor crashes on;
/// where it does not notice, it crashes before. A child may do either.
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
/// are below 1.3 and dihedral angles above 12 degrees, where the surface lets them ("q"), and
/// volumes below the largest ("a").
/// @returns nodes and tetrahedra as TetGen orders them; or why there are none, for people
/// @throws Error when the system gives no process
[[nodiscard]] std::variant<TetMesh, std::string> run_tetgen(const TetgenRequest& request);

}  // namespace palpable
