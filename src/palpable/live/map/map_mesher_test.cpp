#include "palpable/live/map/map_mesher.h"

#include "tests/support/test.h"

#include <algorithm>
#include <array>
#include <vector>

namespace palpable {
namespace {

const PinholeCamera kCamera{320, 180, 170, 170, 165.2, 88.1};
const DepthNoise kNoise{0, 0, 0.012};

// Fuses a wall at 1 m, seen from `x` m aside, twice, so that each voxel has enough weight.
void fuse_wall(SurfaceMap& map, double x) {
  Rigid3 world_from_camera = Rigid3::Identity();
  world_from_camera.translation().x() = x;
  const DepthImage depth(kCamera.width, kCamera.height, 1.0F);
  const ColorImage color(kCamera.width, kCamera.height, Rgb{10, 20, 30});
  for (int i = 0; i < 40; ++i) map.fuse(depth, kCamera, world_from_camera, {}, color);
}

std::vector<std::array<float, 3>> sorted(const MapMesh& mesh) {
  std::vector<std::array<float, 3>> points;
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i) {
    points.push_back({mesh.vertices(0, i), mesh.vertices(1, i), mesh.vertices(2, i)});
  }
  std::sort(points.begin(), points.end());
  return points;
}

TEST_CASE("a mesh comes when the copy is complete and the frames are over, whatever the thread did",
          "[map][map_mesher]") {
  SurfaceMap map(kNoise);
  MapMesher mesher({.blocks_per_frame = 100, .frames_to_mesh = 4});
  for (int n = 0; n < 10; ++n) CHECK(mesher.advance(map) == nullptr);  // nothing to mesh
  fuse_wall(map, 0);
  const int copying = (map.blocks() + 99) / 100;
  REQUIRE(copying > 2);
  for (int round = 0; round < 2; ++round) {
    // One more call finds that no blocks are left, unless the last copied part ends at the end.
    int calls = 0;
    const MapMesh* mesh = nullptr;
    while (mesh == nullptr) {
      mesh = mesher.advance(map);
      REQUIRE(++calls <= copying + 1 + 4);
    }
    CHECK(calls >= copying + 4);
    // The same surface; the copy's blocks may lie in another order.
    const MapMesh whole = mesh_of(map);
    CHECK((sorted(*mesh) == sorted(whole)));
    CHECK(mesh->triangles.cols() == whole.triangles.cols());
    CHECK((mesh->colors == whole.colors));  // all are alike
    REQUIRE(mesh->triangles.cols() > 1000);
  }
}

TEST_CASE("the normals of a mesh point to where it was seen from", "[map][map_mesher]") {
  SurfaceMap map(kNoise);
  fuse_wall(map, 0);
  const MapMesh mesh = mesh_of(map);
  REQUIRE(mesh.normals.cols() == mesh.vertices.cols());
  REQUIRE(mesh.colors.size() == static_cast<std::size_t>(mesh.vertices.cols()));
  for (Eigen::Index i = 0; i < mesh.normals.cols(); ++i) {
    CHECK((mesh.normals.col(i).isZero() || mesh.normals.col(i).z() < -0.9F));
  }
}

TEST_CASE("a map may change while it is copied; what is new comes with the next mesh",
          "[map][map_mesher]") {
  SurfaceMap map(kNoise);
  MapMesher mesher({.blocks_per_frame = 60, .frames_to_mesh = 1});
  fuse_wall(map, 0);
  const auto right_edge = [](const MapMesh& mesh) { return mesh.vertices.row(0).maxCoeff(); };
  CHECK(mesher.advance(map) == nullptr);  // a part of the map is copied
  fuse_wall(map, 1);
  const MapMesh* mesh = nullptr;
  int meshes = 0;
  float edge = 0;
  for (int n = 0; n < 100 && meshes < 2; ++n) {
    mesh = mesher.advance(map);
    if (mesh == nullptr) continue;
    ++meshes;
    edge = right_edge(*mesh);
  }
  REQUIRE(meshes == 2);
  CHECK(edge == right_edge(mesh_of(map)));
}

TEST_CASE("while the thread meshes, the map goes on growing", "[map][map_mesher][threads]") {
  SurfaceMap map(kNoise);
  MapMesher mesher({.blocks_per_frame = 1 << 20, .frames_to_mesh = 2});
  fuse_wall(map, 0);
  for (int round = 0; round < 2; ++round) {
    INFO("round " << round);
    const auto before = sorted(mesh_of(map));
    CHECK(mesher.advance(map) == nullptr);  // all is copied: the thread is working
    fuse_wall(map, 1 + round);
    CHECK(mesher.advance(map) == nullptr);
    const MapMesh* mesh = mesher.advance(map);
    REQUIRE(mesh != nullptr);
    CHECK((sorted(*mesh) == before));
  }
}

}  // namespace
}  // namespace palpable
