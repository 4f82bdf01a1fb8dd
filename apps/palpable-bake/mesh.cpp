// palpable mesh SURFACE -o body.msh

#include "apps/common/command_line.h"
#include "apps/palpable-bake/commands.h"
#include "palpable/base/error.h"
#include "palpable/describe/body_mesh.h"
#include "palpable/geometry/mesh_file.h"
#include "palpable/mesh/msh_file.h"
#include "palpable/mesh/remesh.h"
#include "palpable/mesh/tetrahedralise.h"

#include <fmt/core.h>

#include <memory>
#include <optional>
#include <string>

namespace palpable::app {
namespace {

struct Options {
  std::string surface;
  std::string output;
  std::optional<double> edge, height;
  std::string up = "z";
  int order = 1;
};

void mesh(const Options& options) {
  SurfaceMesh surface = value_or_throw(read_surface_file(options.surface));
  require_solid_surface(surface, options.surface);
  // Only a wish about the placing moves the mesh; otherwise it stays where the file has it.
  if (options.height || options.up != "z") {
    const UpAxis up = options.up == "x" ? UpAxis::kX : options.up == "y" ? UpAxis::kY : UpAxis::kZ;
    place_in_body_frame(surface.vertices, up, options.height);
  }
  if (options.edge) surface = remesh_surface(surface, *options.edge, options.surface);
  TetMesh volume = tetrahedralise(surface, options.surface);
  if (options.order == 2) volume = with_edge_nodes(volume);
  write_msh_file(options.output, volume);
  const TetQuality quality = quality_of(volume);
  fmt::print(
      "{}: {} nodes, {} tetrahedra, boundary {} vertices and {} triangles,\n"
      "volume {:.4g} m^3, dihedral angles {:.1f} to {:.1f} degrees, mean edge {:.3g} m\n",
      options.output, volume.node_count(), volume.tet_count(), surface.vertex_count(),
      surface.triangle_count(), quality.volume, quality.smallest_dihedral_degrees,
      quality.largest_dihedral_degrees, mean_edge_length(surface));
}

}  // namespace

void add_mesh(Command app) {
  const auto options = std::make_shared<Options>();
  Command command = app.add_subcommand("mesh", "Fill a watertight surface with tetrahedra");
  command.add_option("surface", options->surface, "Surface: .stl .ply .obj .3ds .off")
      .required()
      .type_name("SURFACE");
  command.add_option("-o,--out", options->output, "Gmsh file (.msh, ASCII) to write")
      .required()
      .type_name("FILE");
  command
      .add_option("--edge", options->edge,
                  "Remesh the surface to this edge length first, in metres (after --height)")
      .in_range(1e-6, 1e3)
      .type_name("METRES");
  command
      .add_option("--height", options->height,
                  "Scale to this height in metres and stand it on Z = 0")
      .in_range(1e-6, 1e3)
      .type_name("METRES");
  command.add_option("--up", options->up, "Axis of the file that points up: x, y or z")
      .one_of({"x", "y", "z"})
      .show_default();
  command
      .add_option("--order", options->order,
                  "1: tetrahedra of 4 nodes; 2: of 10, with one in the middle of each edge")
      .in_range(1, 2)
      .show_default();
  command.footer("Example: palpable mesh bunny.off -o bunny.msh --up y --height 0.15 --edge 0.007");
  command.callback([options] { mesh(*options); });
}

}  // namespace palpable::app
