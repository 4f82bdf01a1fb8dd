#include "palpable/live/map/map_mesher.h"

#include "palpable/common/base/contract.h"

#include <system_error>
#include <utility>

namespace palpable {

MapMesh mesh_of(const SurfaceMap& map) {
  constexpr double kLeastWeight = 0.25;
  ColoredSurface surface = map.mesh(kLeastWeight);
  MapMesh mesh;
  mesh.vertices = surface.surface.vertices.cast<float>();
  mesh.triangles = std::move(surface.surface.triangles);
  mesh.colors = std::move(surface.colors);
  mesh.normals.resize(3, mesh.vertices.cols());
  vertex_normals(mesh.vertices, mesh.triangles, mesh.normals);
  return mesh;
}

MapMesher::MapMesher(const MapMesherSettings& settings) : settings_(settings) {
  PALPABLE_EXPECT(settings.blocks_per_frame >= 1, "each call copies a block at least");
  PALPABLE_EXPECT(settings.frames_to_mesh >= 1, "a mesh takes a frame at least");
}

MapMesher::~MapMesher() = default;  // a future of std::async waits for its thread

const MapMesh* MapMesher::advance(const SurfaceMap& map) {
  if (work_.valid()) {
    if (++waited_ < settings_.frames_to_mesh) return nullptr;
    mesh_ = work_.get();
    copy_->clear();
    next_slot_ = 0;
    return &mesh_;
  }
  if (map.blocks() == 0) return nullptr;
  if (!copy_) copy_.emplace(map.noise(), map.settings());
  next_slot_ = map.copy_blocks(next_slot_, settings_.blocks_per_frame, *copy_);
  if (next_slot_ < map.capacity()) return nullptr;
  waited_ = 0;
  const auto mesh = [this] { return mesh_of(*copy_); };
  try {
    work_ = std::async(std::launch::async, mesh);
  } catch (const std::system_error&) {  // no thread available: the last call computes the mesh
    work_ = std::async(std::launch::deferred, mesh);
  }
  return nullptr;
}

}  // namespace palpable
