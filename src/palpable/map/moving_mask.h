/// @file
/// What moves in a depth image: what stands where the scene has been seen free, and what stands
/// before the surface that the map knows, beyond the sensor's error; and of what has no depth, what
/// does not look as the scene did.
///
///   tile  a square of 4 x 4 pixels of the depth image
#pragma once

#include "palpable/depth/depth_camera.h"
#include "palpable/depth/depth_noise.h"
#include "palpable/geometry/camera.h"
#include "palpable/geometry/image.h"
#include "palpable/geometry/rigid.h"
#include "palpable/map/free_space.h"
#include "palpable/map/mask_outline.h"
#include "palpable/map/scene_canvas.h"
#include "palpable/map/static_picture.h"
#include "palpable/map/surface_map.h"
#include "palpable/map/tile_groups.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace palpable {

struct MovingMaskSettings {
  FreeSpaceSettings space{};
  /// A depth agrees with the map when it is less than this before its surface, m, or less than so
  /// many sigma of the depth.
  double step = 0.015;
  double sigmas = 4;
  /// A surface that was fused from fewer frames explains nothing yet: it may be the hand's own.
  double frames_to_trust = 6;
  TileGroupSettings groups{};
  int grow_px = 4;   ///< how far the mask reaches into pixels of unknown depth at its border
  bool look = true;  ///< false: depth alone decides, to see what the picture is worth
};

/// Keeps the free space, and a picture of the scene while the camera stands or sways
/// (static_picture.h, scene_canvas.h). All memory is taken when it is made and at the first frame.
class MovingMask {
 public:
  /// @throws ContractViolation for settings out of their range
  MovingMask(const DepthNoise& noise, const MovingMaskSettings& settings = {});

  /// The mask of one frame: 255 where something moves, of the depth's size.
  ///
  /// 1. Each tile's middle depth is looked up. The map's signed distance there says first: before
  ///    the surface by more than the tolerance, it moves; within it, it is static once the surface
  ///    has been seen often enough. Where the map does not tell, it moves in a free cell, and
  ///    nothing explains it elsewhere. What is too close to be measured moves: nothing static
  ///    comes nearer to a hand-held camera than 0.12 m.
  /// 2. While the camera stands or sways, a tile that looks as the scene does is static whatever
  ///    its depth, and one without depth that does not moves.
  /// 3. What nothing explains moves when it hangs together in depth with what moves: a hand that
  ///    reaches into space which was not seen before (tile_groups.h).
  /// 4. Pixels follow the edges of depth and look (mask_outline.h).
  ///
  /// @param world_from_camera  this frame's, or foretold: an error of a tenth of the step is
  /// nothing
  /// @param map                may be null: then free space alone says it
  const MaskImage& find(const SeenFrame& seen, const Rigid3& world_from_camera,
                        const SurfaceMap* map);

  /// Takes in where the frame of the last find() saw through. Call it when the pose is known; a
  /// frame whose pose is not known is left out.
  void learn(const Rigid3& world_from_camera);

  [[nodiscard]] const FreeSpace& space() const { return space_; }
  [[nodiscard]] const MovingMaskSettings& settings() const { return settings_; }

 private:
  struct Question {  // of a tile
    Eigen::Vector3f point;
    const Voxel* voxel;  // of the map there, or null
    float depth;         // m
    int i, j;
    int tiles;  // it is for so many beside each other; if 2 or 4, for those below them too
  };

  void resize(const DepthImage& depth);
  void sample(const SeenFrame& seen);
  void find_alike(int j, int j1);
  void label(const Rigid3& world_from_camera, const SurfaceMap* map);
  void compare_look(const SeenFrame& seen, const Rigid3& world_from_camera);
  void find_ray_depths();

  DepthNoise noise_;
  MovingMaskSettings settings_;
  FreeSpace space_;
  std::pair<int, int> depth_size_;  // px, of the memory
  PinholeCamera depth_camera_;
  PinholeCamera tiles_;  // a pixel per tile
  DepthImage tile_depth_;
  Image<std::uint8_t> tile_label_;
  DepthImage ray_depth_;  // of 2 x 2 tiles: the nearest
  std::vector<Question> questions_;
  std::vector<float> columns_, highest_, sums_;  // of a row of tiles or two
  std::vector<float> alike_;
  TileGroups groups_;
  Image<std::uint8_t> tile_moves_;  // 1 or 0
  MaskOutline outline_;

  StaticPicture picture_;                     // of a camera that stands
  Rigid3 picture_pose_ = Rigid3::Identity();  // from where it was taken
  int stood_;                                 // frames since it was begun
  SceneCanvas canvas_;                        // of one that sways
  StaticPicture drawn_;                       // the canvas as this frame should show it
  PictureView view_;
  bool moved_ = false;                       // something, in the last frame
  int compares_ = 0;                         // frames in which it stood or swayed
  const StaticPicture* compared_ = nullptr;  // with which of them this frame was, if with any
  Image<std::uint8_t> tile_static_;          // not 0: the tile's depth is the scene's
};

}  // namespace palpable
