/// @file
/// The surface of a map that goes on growing, meshed on a thread of its own: for pictures of it.
#pragma once

#include "palpable/geometry/image.h"
#include "palpable/map/surface_map.h"

#include <Eigen/Core>

#include <future>
#include <optional>
#include <vector>

namespace palpable {

/// A surface as a renderer wants it. World frame, m; N vertices, M triangles.
struct MapMesh {
  Eigen::Matrix3Xf vertices;   ///< (3 x N)
  Eigen::Matrix3Xf normals;    ///< (3 x N) unit, to the side it was seen from; 0 where none is
  Eigen::Matrix3Xi triangles;  ///< (3 x M) counter-clockwise seen from that side
  std::vector<Rgb> colors;     ///< (N)
};

/// SurfaceMap::mesh from a quarter of its usual weight on: to be looked at, a surface that is seen
/// from afar is better than a hole.
[[nodiscard]] MapMesh mesh_of(const SurfaceMap& map);

struct MapMesherSettings {
  int blocks_per_frame = 256;  ///< copied in one call at most: 1.5 MB
  /// So many calls after the last block was copied the mesh is handed out: not sooner, so that it
  /// does not depend on how fast the thread was; then the call waits for it.
  int frames_to_mesh = 15;
};

/// Copies the map a part per frame, meshes the copy on a thread and begins anew. What is handed out
/// depends on the calls alone. Its copy takes as much memory as the map.
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
  int next_slot_ = 0;  // to be copied
  int waited_ = 0;     // calls since the copy was complete
  std::future<MapMesh> work_;
  MapMesh mesh_;
};

}  // namespace palpable
