#include "palpable/mesh/tetrahedralise.h"

#include "palpable/base/contract.h"
#include "palpable/base/error.h"
#include "palpable/mesh/remesh.h"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#define TETLIBRARY  // tetgen.h then throws an int where the program would exit
#include <tetgen.h>

namespace palpable {
namespace {

// Largest volume of a tetrahedron over the cube of the surface's edge. A regular one has 0.118;
// 0.26 makes inner edges as long as the surface's, and gives the paper's bunny its 16.5k
// nodes at its 7.5k surface triangles.
constexpr double kVolumeOfEdgeCubed = 0.26;

// What TetGen's numbers mean (terminatetetgen in tetgen.h).
const char* tetgen_complaint(int code) {
  switch (code) {
    case 1:
      return "out of memory";
    case 3:
      return "the surface passes through itself";
    case 4:
      return "the surface has features too small to resolve; remesh it with --edge";
    case 5:
      return "two facets are nearly coplanar; remesh the surface with --edge";
    case 10:
      return "an input error";
    default:
      return "an internal error; remesh the surface with another --edge";
  }
}

// Hands the surface over: TetGen frees what it is given with delete[].
void fill(tetgenio& in, const SurfaceMesh& surface) {
  in.numberofpoints = surface.vertex_count();
  in.pointlist = new REAL[surface.vertices.size()];
  std::copy_n(surface.vertices.data(), surface.vertices.size(), in.pointlist);
  in.numberoffacets = surface.triangle_count();
  in.facetlist = new tetgenio::facet[surface.triangle_count()];
  for (int t = 0; t < surface.triangle_count(); ++t) {
    tetgenio::facet& facet = in.facetlist[t];
    tetgenio::init(&facet);
    facet.numberofpolygons = 1;
    facet.polygonlist = new tetgenio::polygon[1];
    tetgenio::init(&facet.polygonlist[0]);
    facet.polygonlist[0].numberofvertices = 3;
    facet.polygonlist[0].vertexlist = new int[3];
    std::copy_n(surface.triangles.col(t).data(), 3, facet.polygonlist[0].vertexlist);
  }
}

}  // namespace

TetMesh tetrahedralise(const SurfaceMesh& surface, const std::string& name,
                       std::optional<double> inner_edge) {
  require_solid_surface(surface, name);
  tetgenio in, out;
  fill(in, surface);
  const double largest_volume =
      kVolumeOfEdgeCubed * std::pow(inner_edge ? *inner_edge : mean_edge_length(surface), 3);
  // p: a surface is given; Y: keep it; q: radius to edge ratio and smallest dihedral angle,
  // degrees; a: largest volume, m^3; Q: say nothing.
  std::string switches = fmt::format("pYQq1.3/12a{:.9f}", largest_volume);
  if (largest_volume < 1e-6) switches = fmt::format("pYQq1.3/12a{:.17f}", largest_volume);
  tetgenbehavior behavior;
  if (!behavior.parse_commandline(switches.data())) {
    throw Error(fmt::format("{}: TetGen refuses '{}'", name, switches));
  }
  try {
    tetrahedralize(&behavior, &in, &out);
  } catch (const int code) {
    throw Error(fmt::format("{}: cannot be filled with tetrahedra: {} (TetGen's code {})", name,
                            tetgen_complaint(code), code));
  }

  TetMesh mesh;
  mesh.nodes = Eigen::Map<const Eigen::Matrix3Xd>(out.pointlist, 3, out.numberofpoints);
  mesh.tets = Eigen::Map<const Eigen::Matrix4Xi>(out.tetrahedronlist, 4, out.numberoftetrahedra);
  if (mesh.tet_count() == 0) throw Error(fmt::format("{}: TetGen made no tetrahedra", name));
  Eigen::VectorXd volumes = tet_volumes(mesh);
  if (volumes.sum() < 0.0) {  // TetGen orders them the other way round
    mesh.tets.row(2).swap(mesh.tets.row(3));
    volumes = -volumes;
  }
  Eigen::Index worst = 0;
  if (volumes.minCoeff(&worst) <= 0.0) {
    throw Error(
        fmt::format("{}: TetGen made a tetrahedron without volume ({}); remesh the surface "
                    "with another --edge",
                    name, worst));
  }
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
