/// @file
/// Meshes a map that goes on growing, on a thread of its own, for pictures of it.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/live/map/surface_map.h"

#include <Eigen/Core>

#include <future>
#include <optional>
#include <vector>

namespace palpable {

/// A surface as a renderer wants it. World frame, m; N vertices, M triangles.
struct MapMesh {
  Eigen::Matrix3Xf vertices;   ///< (3 x N)
  Eigen::Matrix3Xf normals;    ///< (3 x N) unit, towards where it was seen from; 0 where a vertex
                               ///< has no triangle
  Eigen::Matrix3Xi triangles;  ///< (3 x M) counter-clockwise seen from that side
  std::vector<Rgb> colors;     ///< (N)
};

/// SurfaceMap::mesh() of all that has a quarter of the usual weight: in a picture, a surface that
/// was seen from afar only is better than a hole.
[[nodiscard]] MapMesh mesh_of(const SurfaceMap& map);

struct MapMesherSettings {
  int blocks_per_frame = 256;  ///< that one call copies at most: 1 MiB
  /// Calls between the last block's copy and the new mesh. Not sooner, even if the thread is done,
  /// and not later (the call waits): so pictures do not depend on how fast the thread was.
  int frames_to_mesh = 15;
};

/// Copies the map, a part of it per frame, meshes the copy on a thread, and begins again. What it
/// returns depends on the calls alone. The copy takes as much memory as the map.
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
