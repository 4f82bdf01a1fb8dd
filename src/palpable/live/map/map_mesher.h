/// @file
/// Meshes a map on a thread of its own while the map goes on growing, in order to draw it.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/live/map/surface_map.h"

#include <Eigen/Core>

#include <future>
#include <optional>
#include <vector>

namespace palpable {

/// A surface in the layout that a renderer needs. World frame, m; N vertices, M triangles.
struct MapMesh {
  Eigen::Matrix3Xf vertices;   ///< (3 x N)
  Eigen::Matrix3Xf normals;    ///< (3 x N) unit, towards the side from which it was seen; 0 where a
                               ///< vertex has no triangle
  Eigen::Matrix3Xi triangles;  ///< (3 x M) counter-clockwise seen from that side
  std::vector<Rgb> colors;     ///< (N)
};

/// SurfaceMap::mesh() of all voxels that have a quarter of the usual weight: in a picture, a
/// surface that was only seen from afar is better than a hole.
[[nodiscard]] MapMesh mesh_of(const SurfaceMap& map);

struct MapMesherSettings {
  int blocks_per_frame = 256;  ///< blocks that one call copies at most: 1 MiB
  /// Calls between the copy of the last block and the return of the new mesh. The mesh is not
  /// returned earlier, even if the thread has finished, nor later (the call waits), so that
  /// pictures do not depend on the speed of the thread.
  int frames_to_mesh = 15;
};

/// Copies the map, a part of it per frame, meshes the copy on a thread, and starts again. What it
/// returns depends only on the calls, not on timing. The copy takes as much memory as the map.
class MapMesher {
 public:
  /// @throws ContractViolation for settings below 1
  explicit MapMesher(const MapMesherSettings& settings = {});
  ~MapMesher();

  /// Call it once a frame, always with the same map.
  /// @return a new mesh, valid until the next one is returned; null when there is none
  const MapMesh* advance(const SurfaceMap& map);

 private:
  MapMesherSettings settings_;
  std::optional<SurfaceMap> copy_;
  int next_slot_ = 0;  // slot of the map from which the next call copies
  int waited_ = 0;     // calls since the copy was complete
  std::future<MapMesh> work_;
  MapMesh mesh_;
};

}  // namespace palpable
