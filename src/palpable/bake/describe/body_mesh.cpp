#include "palpable/bake/describe/body_mesh.h"

#include "palpable/bake/describe/body_size.h"
#include "palpable/bake/describe/places.h"
#include "palpable/bake/mesh/mesh_limits.h"
#include "palpable/bake/mesh/remesh.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/geometry/mesh_file.h"
#include "palpable/common/geometry/shells.h"
#include "palpable/common/geometry/size_text.h"
#include "palpable/common/geometry/surface_repair.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <system_error>
#include <utility>

namespace palpable {

void place_in_body_frame(Eigen::Matrix3Xd& points, UpAxis up, std::optional<double> height) {
  PALPABLE_EXPECT(points.cols() > 0, "there are points to place");
  PALPABLE_EXPECT(!height || *height > 0.0, "a height is positive");
  // Cyclic permutations are rotations.
  const Eigen::Matrix3Xd given = points;
  const int up_row = up == UpAxis::kX ? 0 : up == UpAxis::kY ? 1 : 2;
  for (int k = 0; k < 3; ++k) points.row(k) = given.row((up_row + 1 + k) % 3);

  Eigen::Vector3d low = points.rowwise().minCoeff();
  const Eigen::Vector3d high = points.rowwise().maxCoeff();
  if (!(high[2] > low[2])) throw Error("the shape has no height along its up axis");
  const Eigen::Vector3d foot(0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), low[2]);
  points.colwise() -= foot;
  if (height) points *= *height / (high[2] - low[2]);
}

Boundary split_boundary_of(const TetMesh& mesh) {
  return boundary_of(mesh.is_quadratic() ? split_into_eight(mesh) : mesh);
}

namespace {

// Throws where a mesh in build/meshes is missing. The bodies of this repository refer to meshes
// that are not part of it: tools/setup.sh downloads or makes them there, the larger ones only on
// request.
void require_made(const std::filesystem::path& file) {
  std::error_code ignored;
  const std::filesystem::path folder = file.lexically_normal().parent_path();
  if (folder.filename() != "meshes" || folder.parent_path().filename() != "build" ||
      std::filesystem::exists(file, ignored)) {
    return;
  }
  throw Error(fmt::format("{}: no such file; 'tools/setup.sh bodies' makes it", file.string()));
}

// @param points  in the axes of the file, m
void place(Eigen::Matrix3Xd& points, const BodyDescription::Shape& shape) {
  try {
    place_in_body_frame(points, shape.up, shape.height);
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", shape.file.string(), error.what()));
  }
}

VolumeMesh read_volume(const BodyDescription::Shape& shape) {
  require_made(shape.file);
  VolumeMesh volume = value_or_throw(read_volume_file(shape.file));
  require_no_stray(volume.mesh.nodes, shape.file.string());
  volume.mesh.nodes *= shape.unit;
  place(volume.mesh.nodes, shape);
  return volume;
}

// @param solid   whether to refuse a surface that encloses no solid; messages give positions in the
//                file's lengths
// @param repair  if given, a surface that is not wrapped is repaired, and this is set to what was
SurfaceMesh read_surface(const BodyDescription::Shape& shape, bool solid,
                         std::string* repair = nullptr) {
  require_made(shape.file);
  SurfaceMesh surface = value_or_throw(read_surface_file(shape.file));
  require_no_stray(surface.vertices, shape.file.string());
  if (repair != nullptr && !shape.wrap) *repair = repair_surface(surface).describe();
  if (solid) require_solid_surface(surface, shape.file.string());
  if (surface.vertex_count() == 0) {
    throw Error(fmt::format("{}: there are no triangles in it", shape.file.string()));
  }
  surface.vertices *= shape.unit;
  place(surface.vertices, shape);
  return surface;
}

// Wraps, remeshes and fills a surface as the shape specifies. @param made  set to the steps taken,
// as text for the user
TetMesh mesh_of_surface(SurfaceMesh surface, const BodyDescription::Shape& shape,
                        std::string& made) {
  const std::string name = shape.file.string();
  made = "TetGen 1.5";
  if (shape.wrap) surface = wrap_surface(surface, *shape.wrap, name);
  if (shape.edge) {
    require_meshable(surface, *shape.edge, shape.inner_edge.value_or(*shape.edge), name);
    surface = remesh_surface(surface, *shape.edge, name, !shape.wrap);
    made = fmt::format("CGAL isotropic remeshing to {:.4g} m, TetGen 1.5", *shape.edge);
  }
  if (shape.wrap) {
    // The wrap is a little larger than what it is around.
    place_in_body_frame(surface.vertices, UpAxis::kZ, shape.height);
    made = fmt::format("CGAL alpha wrapping with {:.4g} m, {}", *shape.wrap, made);
  }
  return tetrahedralise(surface, name, shape.inner_edge);
}

// The tetrahedra of the shape in the body frame. @param made  set to the steps taken, as text for
// the user
VolumeMesh make_volume(const BodyDescription::Shape& shape, std::string& made) {
  VolumeMesh volume;
  if (shape.is_volume()) {
    volume = read_volume(shape);
    require_possible_size(shape, extent_of(volume.mesh.nodes));
    if (shape.order == 1 && volume.mesh.is_quadratic()) {
      throw Error(fmt::format("{} is 1, but '{}' has 10-node tetrahedra; leave 'order' out",
                              shape.order_place, shape.file.filename().string()));
    }
    made = "tetrahedra as in the file";
  } else {
    SurfaceMesh surface = read_surface(shape, !shape.wrap, &volume.repair);
    require_possible_size(shape, extent_of(surface.vertices));
    volume.mesh = mesh_of_surface(std::move(surface), shape, made);
  }
  if (!volume.repair.empty()) made = fmt::format("{}, {}", volume.repair, made);
  if (shape.order == 2 && !volume.mesh.is_quadratic()) {
    volume = with_edge_nodes(std::move(volume));
    made += ", a node in the middle of each edge";
  }
  return volume;
}

// How all supports together hold one node.
struct Hold {
  int by[3] = {-1, -1, -1};  // the support that holds each direction
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
};

void hold_nodes(const VolumeMesh& volume, const BodyDescription& description, BodyMesh& body) {
  std::map<int, Hold> holds;
  for (std::size_t s = 0; s < description.supports.size(); ++s) {
    const BodyDescription::Support& support = description.supports[s];
    for (const int n : nodes_at(volume, support.where)) {
      Hold& hold = holds[n];
      for (int i = 0; i < 3; ++i) {
        if (!support.held[i]) continue;
        if (hold.by[i] >= 0 && hold.displacement[i] != support.displacement[i]) {
          const Eigen::Vector3d X = volume.mesh.nodes.col(n);
          throw Error(fmt::format(
              "{}: moves the node at ({:.4g}, {:.4g}, {:.4g}) m by {} m in {}, but {} by {} m: let "
              "each node be held in each direction by one of them",
              support.where.place, X[0], X[1], X[2], support.displacement[i], "xyz"[i],
              description.supports[hold.by[i]].where.place, hold.displacement[i]));
        }
        hold.by[i] = static_cast<int>(s);
        hold.displacement[i] = support.displacement[i];
      }
    }
  }
  for (const auto& [node, hold] : holds) {
    const Eigen::Array<bool, 3, 1> held(hold.by[0] >= 0, hold.by[1] >= 0, hold.by[2] >= 0);
    if (held.all() && hold.displacement.isZero(0.0)) {
      body.fixed_nodes.push_back(node);
    } else {
      body.supports.push_back({node, held, hold.displacement});
    }
  }
}

BodyMesh body_of(VolumeMesh volume, const BodyDescription& description, const std::string& made) {
  BodyMesh body;
  hold_nodes(volume, description, body);
  body.mesh = std::move(volume.mesh);
  body.sets = std::move(volume.sets);
  body.boundary = split_boundary_of(body.mesh);
  // Remeshing may leave the lowest vertex a little above Z = 0.
  body.height = body.mesh.nodes.row(2).maxCoeff() - body.mesh.nodes.row(2).minCoeff();
  body.quality = quality_of(body.mesh);
  body.origin = fmt::format("{}, {}", description.shape.file.filename().string(), made);
  return body;
}

}  // namespace

std::optional<std::string> wrap_warning(const BodyDescription::Shape& shape) {
  if (!shape.wrap) return std::nullopt;
  const SurfaceMesh surface = read_surface(shape, false);
  if (!check_watertight(surface).watertight() || !misplaced_shell(surface).empty()) {
    return std::nullopt;
  }
  const std::vector<std::vector<int>> shells = shells_of(surface);
  const auto cavities = std::count_if(shells.begin(), shells.end(), [&](const auto& shell) {
    return enclosed_volume(surface_of(surface, shell)) < 0.0;
  });
  if (cavities == 0) return std::nullopt;
  return fmt::format(
      "{}: the surface has {} {}, which a wrap fills, since it goes around the outside; without "
      "'wrap' {} empty",
      shape.place, cavities, cavities == 1 ? "cavity" : "cavities",
      cavities == 1 ? "it stays" : "they stay");
}

bool is_of_ten_nodes(const BodyDescription::Shape& shape) {
  if (shape.order) return *shape.order == 2;
  return shape.is_volume() && read_volume(shape).mesh.is_quadratic();
}

Eigen::Vector3d size_of_body(const BodyDescription& description, std::string* repair) {
  const BodyDescription::Shape& shape = description.shape;
  if (repair != nullptr) repair->clear();
  if (shape.is_volume()) {
    VolumeMesh volume = read_volume(shape);
    if (repair != nullptr) *repair = std::move(volume.repair);
    return extent_of(volume.mesh.nodes);
  }
  return extent_of(read_surface(shape, false, repair).vertices);
}

BodyMesh make_body_mesh(const BodyDescription& description) {
  std::string made;
  VolumeMesh volume = make_volume(description.shape, made);
  return body_of(std::move(volume), description, made);
}

BodyMesh remeshed(const BodyDescription& description, const SurfaceMesh& skin, double edge) {
  const BodyDescription::Shape& shape = description.shape;
  const std::string name = shape.file.string();
  const SurfaceMesh coarse = remesh_surface(skin, edge, name, !shape.wrap);
  VolumeMesh volume{tetrahedralise(coarse, name, {}), {}};
  if (shape.order == 2) volume = with_edge_nodes(std::move(volume));
  return body_of(std::move(volume), description,
                 fmt::format("its skin remeshed to {:.4g} m, TetGen 1.5", edge));
}

std::vector<std::uint8_t> held_nodes(const BodyMesh& body) {
  std::vector<std::uint8_t> held(body.mesh.node_count(), 0);
  for (const int n : body.fixed_nodes) held[n] = 1;
  for (const Support& support : body.supports) { held[support.node] = support.held.all(); }
  return held;
}

}  // namespace palpable
