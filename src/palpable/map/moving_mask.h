/// @file
/// What moves in a depth image: what stands where the scene has been seen free, and what stands
/// before the surface that the map knows, beyond the sensor's error; and of what has no depth, what
/// does not look as the scene did.
///
///   tile  a square of 4 x 4 pixels of the depth image
#pragma once

#include "palpable/geometry/camera.h"
#include "palpable/geometry/image.h"
#include "palpable/geometry/rigid.h"
#include "palpable/map/free_space.h"
#include "palpable/map/scene_canvas.h"
#include "palpable/map/static_picture.h"
#include "palpable/map/surface_map.h"
#include "palpable/vision/depth_camera.h"
#include "palpable/vision/depth_noise.h"

#include <cstdint>
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
  /// Neighbours whose depths differ by less than this share of them belong to one thing.
  double same_share = 0.05;
  /// What moved so many frames ago or less, and is explained by nothing now, goes on moving; < 127.
  int frames_to_carry = 8;
  int grow_px = 4;  ///< how far the mask reaches into pixels of unknown depth at its border
  double most_unexplained = 8;  ///< tiles that join a moving group, times its own number
  int fewest_tiles = 20;        ///< a connected group of fewer tiles is noise
  bool look = true;             ///< false: depth alone decides, to see what the picture is worth
};

/// Keeps the free space, and a picture of the scene while the camera stands or sways
/// (static_picture.h, scene_canvas.h). All
/// memory is taken when it is made and at the first frame.
class MovingMask {
 public:
  MovingMask(const DepthNoise& noise, const MovingMaskSettings& settings = {});

  /// The mask of one frame: 255 where something moves, of the depth's size.
  ///
  /// 1. Each tile's middle depth is looked up. The map's signed distance there says first: before
  ///    the surface by more than the tolerance, it moves; within it, it is static once the surface
  ///    has been seen often enough. Where the map does not tell, it moves in a free cell, and
  ///    nothing explains it elsewhere. What is too close to be measured moves: nothing static
  ///    comes nearer to a hand-held camera than 0.12 m.
  /// 2. What nothing explains moves when it hangs together in depth with what moves: a hand that
  ///    reaches into space which was not seen before.
  ///    While the camera stands or sways, a tile that looks as the scene does is static whatever
  ///    its depth, and one without depth that does not moves.
  /// 3. Pixels take over from the tile around them whose depth is most like theirs, so the mask
  ///    follows depth edges. Holes inside move too; at the left border of near things, which the
  ///    right eye sees instead of what lies behind, unknown pixels are the background's.
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
  // kChanged: without a depth, and it does not look as the scene does.
  enum Label : std::uint8_t { kUnknown, kStatic, kUnexplained, kChanged, kCarried, kMoving };

  struct Tile {
    std::int16_t i, j;
  };

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
  void group();
  void find_border();
  void draw(const DepthImage& depth);
  void draw_border(const DepthImage& depth, int i, int j);
  void fill();
  void find_ray_depths();

  DepthNoise noise_;
  MovingMaskSettings settings_;
  FreeSpace space_;
  PinholeCamera depth_camera_;
  PinholeCamera tiles_;  // a pixel per tile
  DepthImage tile_depth_;
  Image<std::uint8_t> tile_label_;
  DepthImage ray_depth_;  // of 2 x 2 tiles: the nearest
  std::vector<Question> questions_;
  std::vector<Tile> queue_, edge_;
  Image<std::uint8_t> age_;  // of the tiles: frames since it was seen to move; 127: long ago
  DepthImage moved_depth_;   // its depth then
  // Of the tiles: while groups are counted; later whether they or a neighbour move.
  Image<std::uint8_t> seen_;
  Image<std::uint8_t> all_move_;  // with all neighbours
  Image<std::uint8_t> any_beside_, all_beside_;
  std::vector<std::uint8_t> row_;                // of tiles, and one more at both ends
  std::vector<float> columns_, highest_, sums_;  // of a row of tiles or two
  std::vector<float> alike_;
  MaskImage mask_;
  std::vector<std::uint8_t> row_is_empty_;  // of tiles: not 0 where the mask is 0
  std::vector<int> open_;                   // pixels that are not decided yet
  MaskImage above_, below_;

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
