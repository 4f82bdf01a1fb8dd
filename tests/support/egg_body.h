/// @file
/// A small egg with two sites, and its campaign.
#pragma once

#include "palpable/bake/campaign/crew.h"
#include "palpable/bake/campaign/fill_store.h"
#include "palpable/bake/describe/body_description.h"
#include "palpable/common/geometry/mesh_file.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <filesystem>

namespace palpable::test {

/// Writes the egg's surface as FOLDER/egg.ply.
inline void write_egg(const std::filesystem::path& folder, int subdivisions = 2) {
  SurfaceMesh surface = sphere_surface({0, 0, 0}, 1, subdivisions);
  surface.vertices.row(1) *= 1.3;
  write_ply(folder / "egg.ply", surface);
}

/// The description of the egg in a folder that contains its surface, as from FOLDER/egg.toml.
inline BodyDescription egg_description(const std::filesystem::path& folder, int levels) {
  BodyDescription body;
  body.name = "egg";
  body.source = folder / "egg.toml";
  body.shape = {.file = folder / "egg.ply", .up = UpAxis::kY, .height = 0.08, .edge = {}};
  body.material = {.law = "neo-hookean", .young = 40e3, .poisson = 0.35};
  body.supports = {{.where = {Where::Below{0.15}, "egg.toml:9: 'below' in [support]"}}};
  body.supports_place = "egg.toml:8: [support]";
  body.sites = {.count = 2, .above = 0.4, .patch = 1};
  body.press = {.depth = 0.06, .levels = levels};
  return body;
}

/// Writes the surface and returns the description.
inline BodyDescription egg_body(const std::filesystem::path& folder, int levels) {
  write_egg(folder);
  return egg_description(folder, levels);
}

/// The egg's solved snapshots, or those of the levels between the levels of `held_out_of`.
inline SnapshotStore solved_store(const BodyDescription& body, const std::filesystem::path& folder,
                                  const SnapshotStore* held_out_of = nullptr) {
  LocalCrew crew;
  FillSettings settings;
  settings.threads = 1;
  settings.store = folder;
  settings.held_out_of = held_out_of;
  return fill_store(body, settings, crew).store;
}

}  // namespace palpable::test
