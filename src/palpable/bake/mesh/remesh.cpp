#include "palpable/bake/mesh/remesh.h"

#include "palpable/bake/mesh/mesh_limits.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/geometry/place_text.h"
#include "palpable/common/geometry/shells.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/detect_features.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace palpable {
namespace {

namespace PMP = CGAL::Polygon_mesh_processing;
using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;
using Face = Mesh::Face_index;

// Degrees between the triangles of an edge above which it is kept: sharper than any edge of a
// smooth body, less sharp than those of a box.
constexpr double kSharpDegrees = 80.0;
// Rounds of splitting, collapsing, flipping and relaxing; later ones change nothing visible.
constexpr unsigned kRounds = 5;

// Where the sides of a thin part intersect after remeshing, the surface is remeshed again with
// shorter edges around that place, kFinerRounds times at most. Each time the edge there is halved,
// up to kMostHalvings times; it is halved once less in each ring around the place, of kFinerReach
// edge lengths. (CGAL 5.5 takes one length for all faces of a call.)
constexpr int kFinerRounds = 3, kMostHalvings = 2;
constexpr double kFinerReach = 2.0;

// Ratio of a wrap's size to its distance from the triangles. A smaller ratio is visible as a
// thicker body, a larger one is slower.
constexpr double kWrapOffset = 7.0;

Eigen::Vector3d to_eigen(const Point& p) { return {p.x(), p.y(), p.z()}; }

Mesh to_cgal(const SurfaceMesh& surface, const std::string& name) {
  std::vector<Point> points;
  for (const auto& x : surface.vertices.colwise()) points.emplace_back(x[0], x[1], x[2]);
  std::vector<std::array<std::size_t, 3>> triangles;
  for (const auto& t : surface.triangles.colwise()) {
    triangles.push_back({static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]),
                         static_cast<std::size_t>(t[2])});
  }
  if (!PMP::is_polygon_soup_a_polygon_mesh(triangles)) {
    throw Error(fmt::format(
        "{}: two sheets of the surface meet in a single vertex; split it in a mesh editor, or let "
        "'wrap' in a body's description build one surface around them",
        name));
  }
  Mesh mesh;
  PMP::polygon_soup_to_polygon_mesh(points, triangles, mesh);
  return mesh;
}

SurfaceMesh from_cgal(Mesh& mesh) {
  mesh.collect_garbage();
  SurfaceMesh surface;
  surface.vertices.resize(3, static_cast<Eigen::Index>(mesh.number_of_vertices()));
  surface.triangles.resize(3, static_cast<Eigen::Index>(mesh.number_of_faces()));
  for (const auto v : mesh.vertices()) {
    surface.vertices.col(static_cast<Eigen::Index>(v.idx())) = to_eigen(mesh.point(v));
  }
  Eigen::Index t = 0;
  for (const auto f : mesh.faces()) {
    int k = 0;
    for (const auto v : mesh.vertices_around_face(mesh.halfedge(f))) {
      surface.triangles(k++, t) = static_cast<int>(v.idx());
    }
    ++t;
  }
  return surface;
}

Eigen::Vector3d middle_of(const Mesh& mesh, Face face) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto v : mesh.vertices_around_face(mesh.halfedge(face)))
    sum += to_eigen(mesh.point(v));
  return sum / 3;
}

using FacePairs = std::vector<std::pair<Face, Face>>;

// Pairs of faces that intersect, sorted.
FacePairs self_intersections(const Mesh& mesh) {
  FacePairs pairs;
  PMP::self_intersections(mesh, std::back_inserter(pairs));
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

// @param pairs    self_intersections(mesh)
// @param surface  the one that `mesh` was made of: the same triangles in the same order
void refuse(const FacePairs& pairs, const Mesh& mesh, const SurfaceMesh& surface,
            const std::string& name) {
  if (pairs.empty()) return;
  const auto [first, second] = pairs.front();
  const Eigen::Vector3d where = middle_of(mesh, first);
  const std::vector<std::vector<int>> shells = shells_of(surface);
  const auto shell_of = [&](Face face) {
    return std::find_if(shells.begin(), shells.end(), [&](const std::vector<int>& shell) {
      return std::binary_search(shell.begin(), shell.end(), static_cast<int>(face.idx()));
    });
  };
  const std::string place =
      fmt::format("{} pair{} of triangles, the first near {}", pairs.size(),
                  pairs.size() == 1 ? "" : "s", place_text(where, told_apart(surface.vertices)));
  if (shell_of(first) == shell_of(second)) {
    throw Error(fmt::format(
        "{}: the surface passes through itself: {}; repair it in a mesh editor, or let 'wrap' in a "
        "body's description build one surface around it",
        name, place));
  }
  throw Error(fmt::format(
      "{}: of {} closed shells two overlap: {}; join them (\"union\") or move them apart in a mesh "
      "editor, or let 'wrap' in a body's description join them",
      name, shells.size(), place));
}

Mesh closed_mesh(const SurfaceMesh& surface, const std::string& name) {
  const WatertightReport report = check_watertight(surface);
  if (!report.watertight()) throw Error(fmt::format("{}: {}", name, report.describe()));
  return to_cgal(surface, name);
}

// @param mesh   closed_mesh(surface)
// @param pairs  self_intersections(mesh)
void refuse_unless_solid(const FacePairs& pairs, const Mesh& mesh, const SurfaceMesh& surface,
                         const std::string& name) {
  refuse(pairs, mesh, surface, name);
  const std::string misplaced = misplaced_shell(surface);
  if (!misplaced.empty()) throw Error(fmt::format("{}: {}", name, misplaced));
}

Mesh checked(const SurfaceMesh& surface, const std::string& name) {
  Mesh mesh = closed_mesh(surface, name);
  refuse_unless_solid(self_intersections(mesh), mesh, surface, name);
  return mesh;
}

// A place where edges are shorter, and how often they are halved there.
struct FinerPlace {
  Eigen::Vector3d middle;  // m
  int halvings = 1;
};

// Adds places around intersecting faces; halves the edges once more at places that are there
// already.
void make_finer(const FacePairs& pairs, const Mesh& mesh, double edge_length,
                std::vector<FinerPlace>& finer) {
  std::vector<FinerPlace> now = finer;
  for (const auto& [first, second] : pairs) {
    const Eigen::Vector3d place = middle_of(mesh, first);
    const auto at = std::find_if(now.begin(), now.end(), [&](const FinerPlace& other) {
      return (other.middle - place).norm() <= edge_length;
    });
    if (at == now.end()) {
      now.push_back({place, 1});
    } else if (const auto k = static_cast<std::size_t>(at - now.begin()); k < finer.size()) {
      at->halvings = std::min(finer[k].halvings + 1, kMostHalvings);
    }
  }
  finer = std::move(now);
}

// Halvings of the edge length at a point.
int halvings_at(const Eigen::Vector3d& x, double edge_length,
                const std::vector<FinerPlace>& finer) {
  int most = 0;
  for (const FinerPlace& place : finer) {
    const double rings = (x - place.middle).norm() / (kFinerReach * edge_length);
    most = std::max(most, place.halvings - static_cast<int>(rings));
  }
  return most;
}

// Remeshes everything with the shortest edges, then what is farther and farther from the places
// with edges twice as long each time, so that both sides of a transition have been remeshed.
void remesh(Mesh& mesh, double edge_length, const std::vector<FinerPlace>& finer,
            bool keep_sharp_edges) {
  auto sharp = mesh.add_property_map<Mesh::Edge_index, bool>("e:sharp", false).first;
  if (keep_sharp_edges) PMP::detect_sharp_edges(mesh, kSharpDegrees, sharp);
  int most = 0;
  for (const FinerPlace& place : finer) most = std::max(most, place.halvings);
  for (int halvings = most; halvings >= 0; --halvings) {
    std::vector<Face> faces;
    for (const Face face : mesh.faces()) {
      if (halvings == most || halvings_at(middle_of(mesh, face), edge_length, finer) <= halvings) {
        faces.push_back(face);
      }
    }
    PMP::isotropic_remeshing(
        faces, std::ldexp(edge_length, -halvings), mesh,
        PMP::parameters::number_of_iterations(kRounds).edge_is_constrained_map(sharp));
  }
}

}  // namespace

void require_solid_surface(const SurfaceMesh& surface, const std::string& name) {
  (void)checked(surface, name);
}

SurfaceMesh remesh_surface(const SurfaceMesh& surface, double edge_length, const std::string& name,
                           bool keep_sharp_edges) {
  PALPABLE_EXPECT(edge_length > 0.0, "an edge length is positive");
  Mesh mesh = checked(surface, name);
  require_meshable(surface, edge_length, std::numeric_limits<double>::infinity(), name);
  std::vector<FinerPlace> finer;
  SurfaceMesh remeshed;
  try {
    for (int round = 0;; ++round) {
      Mesh coarse = mesh;
      remesh(coarse, edge_length, finer, keep_sharp_edges);
      remeshed = from_cgal(coarse);
      const Mesh found = closed_mesh(remeshed, name);
      const FacePairs pairs = self_intersections(found);
      if (pairs.empty() || round == kFinerRounds) {
        refuse_unless_solid(pairs, found, remeshed, name);
        break;
      }
      make_finer(pairs, found, edge_length, finer);
    }
  } catch (const Error& error) {
    throw Error(fmt::format("{} (after remeshing to an edge of {:.3g} m: try a shorter one)",
                            error.what(), edge_length));
  }
  require_same_volume(surface, enclosed_volume(remeshed), edge_length, name);
  return remeshed;
}

SurfaceMesh wrap_surface(const SurfaceMesh& surface, double size, const std::string& name) {
  PALPABLE_EXPECT(size > 0.0, "a length is positive");
  if (surface.triangle_count() == 0) {
    throw Error(fmt::format("{}: there are no triangles to wrap", name));
  }
  require_wrappable(surface, size, name);
  std::vector<Point> points;
  for (const auto& x : surface.vertices.colwise()) points.emplace_back(x[0], x[1], x[2]);
  std::vector<std::array<std::size_t, 3>> triangles;
  for (const auto& t : surface.triangles.colwise()) {
    triangles.push_back({static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]),
                         static_cast<std::size_t>(t[2])});
  }
  Mesh wrapped;
  CGAL::alpha_wrap_3(points, triangles, size, size / kWrapOffset, wrapped);
  return from_cgal(wrapped);
}

}  // namespace palpable
