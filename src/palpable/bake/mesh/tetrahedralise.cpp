#include "palpable/bake/mesh/tetrahedralise.h"

#include "palpable/bake/mesh/mesh_limits.h"
#include "palpable/bake/mesh/remesh.h"
#include "palpable/bake/mesh/tetgen_process.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/geometry/place_text.h"
#include "palpable/common/geometry/shells.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <variant>

namespace palpable {
namespace {

// Largest volume of a tetrahedron over the cube of the surface's edge. A regular one has 0.118;
// 0.26 makes inner edges as long as the surface's, and gives the paper's bunny its 16.5k
// nodes at its 7.5k surface triangles.
constexpr double kVolumeOfEdgeCubed = 0.26;

// The position of the thinnest triangle, where meshers fail first, as text.
std::string place_of_trouble(const SurfaceMesh& surface) {
  double thinnest = std::numeric_limits<double>::infinity();
  Eigen::Vector3d where = Eigen::Vector3d::Zero();
  for (const auto& t : surface.triangles.colwise()) {
    const Eigen::Vector3d a = surface.vertices.col(t[0]), b = surface.vertices.col(t[1]),
                          c = surface.vertices.col(t[2]);
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const double height = (b - a).cross(c - a).norm() / longest;
    if (height / longest >= thinnest) continue;
    thinnest = height / longest;
    where = (a + b + c) / 3.0;
  }
  return fmt::format("its thinnest triangle, {:.2g} times as long as high, is at {} m",
                     1.0 / thinnest, place_text(where, told_apart(surface.vertices)));
}

}  // namespace

TetMesh tetrahedralise(const SurfaceMesh& surface, const std::string& name,
                       std::optional<double> inner_edge) {
  require_solid_surface(surface, name);
  require_gaps(surface, name);
  const double edge = mean_edge_length(surface), inner = inner_edge.value_or(edge);
  require_meshable(surface, edge, inner, name);
  std::variant<TetMesh, std::string> made =
      run_tetgen({.surface = surface,
                  .largest_volume = kVolumeOfEdgeCubed * std::pow(inner, 3),
                  .holes = points_in_cavities(surface)});
  if (const std::string* why = std::get_if<std::string>(&made)) {
    throw Error(fmt::format("{}: TetGen cannot fill it with tetrahedra: {}; {}", name, *why,
                            place_of_trouble(surface)));
  }
  TetMesh mesh = std::move(std::get<TetMesh>(made));
  Eigen::VectorXd volumes = tet_volumes(mesh);
  if (volumes.sum() < 0.0) {  // TetGen orders them the other way round
    mesh.tets.row(2).swap(mesh.tets.row(3));
    volumes = -volumes;
  }
  Eigen::Index worst = 0;
  if (volumes.minCoeff(&worst) <= 0.0) {
    throw Error(
        fmt::format("{}: TetGen made a tetrahedron without volume ({}); remesh the surface "
                    "with another edge; {}",
                    name, worst, place_of_trouble(surface)));
  }
  require_same_volume(surface, volumes.sum(), 0.0, name);
  return mesh;
}

TetQuality quality_of(const TetMesh& mesh) {
  PALPABLE_EXPECT(mesh.tet_count() > 0, "a mesh has tetrahedra");
  TetQuality quality{180.0, 0.0, tet_volumes(mesh).sum()};
  for (const auto& tet : mesh.tets.colwise()) {
    Eigen::Matrix<double, 3, 4> normals;  // of the face opposite to each node, unit
    for (int k = 0; k < 4; ++k) {
      const Eigen::Vector3d a = mesh.nodes.col(tet[(k + 1) % 4]);
      const Eigen::Vector3d b = mesh.nodes.col(tet[(k + 2) % 4]);
      const Eigen::Vector3d c = mesh.nodes.col(tet[(k + 3) % 4]);
      Eigen::Vector3d n = (b - a).cross(c - a).normalized();
      if (n.dot(mesh.nodes.col(tet[k]) - a) > 0.0) n = -n;  // outwards
      normals.col(k) = n;
    }
    for (int k = 0; k < 4; ++k) {
      for (int l = 0; l < k; ++l) {
        const double cosine = std::clamp(-normals.col(k).dot(normals.col(l)), -1.0, 1.0);
        const double angle = std::acos(cosine) * 180.0 / std::numbers::pi;
        quality.smallest_dihedral_degrees = std::min(quality.smallest_dihedral_degrees, angle);
        quality.largest_dihedral_degrees = std::max(quality.largest_dihedral_degrees, angle);
      }
    }
  }
  return quality;
}

}  // namespace palpable
