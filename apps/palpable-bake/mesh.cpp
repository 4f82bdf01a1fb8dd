// palpable mesh SURFACE -o body.msh

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable-bake/commands.h"
#include "palpable/bake/describe/body_mesh.h"
#include "palpable/bake/describe/body_size.h"
#include "palpable/bake/mesh/mesh_limits.h"
#include "palpable/bake/mesh/remesh.h"
#include "palpable/bake/mesh/tetrahedralise.h"
#include "palpable/bake/pipeline/mesh_output.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/file_format.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/output_name.h"
#include "palpable/common/base/quantity.h"
#include "palpable/common/geometry/mesh_file.h"
#include "palpable/common/geometry/size_text.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/common/geometry/surface_repair.h"

#include <fmt/core.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace palpable::app {
namespace {

struct MeshCommandOptions {
  std::string surface;
  std::string output;
  std::optional<double> edge, height;
  std::string up = "z", unit;
  int order = 1;
  bool json = false;
};

// Printed before meshing: a wrong unit costs minutes and gigabytes.
void print_mesh_size(const MeshCommandOptions& options, const SurfaceMesh& surface, double unit) {
  const Eigen::Vector3d size = extent_of(surface.vertices);
  print_note("{}: {}", options.surface, size_text(size));
  const auto given = options.height ? std::nullopt : std::optional(unit);
  require_possible_size(size, given, "--unit {}", options.surface);
  if (const auto warning = size_warning(size, given, "--unit {}")) {
    fmt::print(stderr, "warning: {}: {}\n", options.surface, *warning);
  }
}

// The surface, repaired, in m; it is moved only if --height or --up is given.
SurfaceMesh placed_surface(const MeshCommandOptions& options) {
  SurfaceMesh surface = value_or_throw(read_surface_file(options.surface));
  require_no_stray(surface.vertices, options.surface);
  const std::string repair = repair_surface(surface).describe();
  if (!repair.empty()) print_note("{}: {}", options.surface, repair);
  require_solid_surface(surface, options.surface);
  const double unit = length_unit(options.unit.empty() ? "m" : options.unit).value();
  surface.vertices *= unit;
  if (options.height || options.up != "z") {
    const UpAxis up = options.up == "x" ? UpAxis::kX : options.up == "y" ? UpAxis::kY : UpAxis::kZ;
    place_in_body_frame(surface.vertices, up, options.height);
  }
  print_mesh_size(options, surface, unit);
  return surface;
}

FileFormat mesh_format(const std::filesystem::path& output) {
  if (output.extension() == ".msh") return FileFormat::kGmsh;
  return output.extension() == ".inp" ? FileFormat::kDeck : FileFormat::kXml;
}

void mesh(const MeshCommandOptions& options) {
  guard_output_file(options.output, {options.surface});
  require_ending(options.output, {kMeshEndings.begin(), kMeshEndings.end()}, "a volume mesh");
  guard_format(options.output, mesh_format(options.output));
  if (options.height && !options.unit.empty()) {
    throw Error(
        "--unit says what lengths in the file are, and --height scales them anew: leave "
        "one of the two out");
  }
  SurfaceMesh surface = placed_surface(options);
  ProgressBar bar;
  const Progress progress = bar.progress();
  if (options.edge) {
    require_meshable(surface, *options.edge, *options.edge, options.surface);
    report(progress, {"meshing", 0.0, 1.0, "edges of one length"});
    surface = remesh_surface(surface, *options.edge, options.surface);
  }
  report(progress, {"meshing", 0.0, 1.0, "tetrahedra"});
  TetMesh volume = tetrahedralise(surface, options.surface);
  if (options.order == 2) volume = with_edge_nodes(volume);
  write_volume_file(options.output, volume);
  report(progress, {"meshing", 1.0, 1.0, "written"});
  bar.finish();
  const TetQuality quality = quality_of(volume);
  if (options.json) {
    print_json({{"file", options.output},
                {"nodes", volume.node_count()},
                {"tetrahedra", volume.tet_count()},
                {"boundary_vertices", surface.vertex_count()},
                {"boundary_triangles", surface.triangle_count()},
                {"volume_m3", quality.volume},
                {"smallest_dihedral_deg", quality.smallest_dihedral_degrees},
                {"largest_dihedral_deg", quality.largest_dihedral_degrees},
                {"mean_edge_m", mean_edge_length(surface)}});
    return;
  }
  print_text(
      "{}: {} nodes, {} tetrahedra, boundary {} vertices and {} triangles,\n"
      "volume {:.4g} m^3, dihedral angles {:.1f} to {:.1f} degrees, mean edge {:.3g} m\n",
      options.output, volume.node_count(), volume.tet_count(), surface.vertex_count(),
      surface.triangle_count(), quality.volume, quality.smallest_dihedral_degrees,
      quality.largest_dihedral_degrees, mean_edge_length(surface));
}

}  // namespace

void add_mesh(Command app) {
  const auto options = std::make_shared<MeshCommandOptions>();
  Command command = app.add_subcommand("mesh", "Fill a watertight surface with tetrahedra");
  command.add_option("surface", options->surface, "Surface: .stl .ply .obj .3ds .off").required();
  command
      .add_option(
          "-o,--out", options->output,
          "Mesh to write, in the format of its name: .msh (Gmsh, ASCII), .vtu (VTK) or .inp "
          "(Abaqus, CalculiX)")
      .required()
      .type_name("FILE");
  command
      .add_length("--edge", options->edge,
                  "Remesh the surface to this edge length first (after --height)", {1e-6, 1e3})
      .default_is("as it is");
  command
      .add_length("--height", options->height,
                  "Scale the surface to this height and stand it on Z = 0", {1e-6, 1e3})
      .default_is("as it is");
  command.add_option("--unit", options->unit, "The unit of lengths in the surface's file")
      .one_of(length_unit_names())
      .default_is("m");
  command.add_option("--up", options->up, "Axis of the file that points up")
      .one_of({"x", "y", "z"})
      .show_default();
  command
      .add_option("--order", options->order,
                  "1: tetrahedra of 4 nodes; 2: of 10, with one in the middle of each edge")
      .in_range(1, 2)
      .show_default();
  command.add_json(options->json);
  command.footer("Example: palpable mesh bunny.off -o bunny.msh --up y --height 150mm --edge 7mm");
  command.callback([options] { mesh(*options); });
}

}  // namespace palpable::app
