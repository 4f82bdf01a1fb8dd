/// @file
/// Which pixels of a frame show something that moves: something that stands where the scene was
/// seen free, or before the surface that the map knows by more than the sensor's error, or that has
/// no depth and does not look as the scene did.
///
///     sample()         one depth per tile
///     label()          each tile by map and free space        (surface_map.h, free_space.h)
///     compare_look()   corrected by how the tile looks        (static_picture.h, scene_canvas.h)
///     TileGroups       neighbours together                    (tile_groups.h)
///     MaskOutline      down to pixels                         (mask_outline.h)
///
///   tile  a square of 4 x 4 pixels of the depth image
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/live/depth/depth_camera.h"
#include "palpable/live/depth/depth_noise.h"
#include "palpable/live/map/free_space.h"
#include "palpable/live/map/mask_outline.h"
#include "palpable/live/map/scene_canvas.h"
#include "palpable/live/map/static_picture.h"
#include "palpable/live/map/surface_map.h"
#include "palpable/live/map/tile_groups.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace palpable {

struct MovingMaskSettings {
  FreeSpaceSettings space{};
  /// A depth agrees with the map when it lies at most max(step, sigmas * sigma_Z) before or behind
  /// its surface.
  double step = 0.015;  ///< m
  double sigmas = 4;
  /// Frames from which a surface must have been fused before a depth that agrees with it is static.
  /// With fewer it may be the surface of the hand itself.
  double frames_to_trust = 6;
  TileGroupSettings groups{};
  int grow_px = 4;   ///< how far the mask reaches into pixels of unknown depth at its border
  bool look = true;  ///< false: depth alone decides, to see what comparing looks is worth
};

/// With what a frame's look was compared.
enum class LookedAt {
  kNothing,    ///< a camera that walks
  kDrawnView,  ///< one that sways: a view drawn from the canvas, which may be off by a pixel
  kPicture     ///< one that stands
};

/// Finds the mask of each frame. Owns the free space, and the pictures of the scene for a camera
/// that stands (static_picture.h) or sways (scene_canvas.h). Allocates in its constructor and at
/// the first frame only.
class MovingMask {
 public:
  /// @throws ContractViolation for settings out of their range
  MovingMask(const DepthNoise& noise, const MovingMaskSettings& settings = {});

  /// The mask of one frame: 255 where something moves, of the depth's size.
  ///
  /// 1. The depth in the middle of each tile is looked up in the map. Before the map's surface by
  /// more
  ///    than the tolerance, the tile moves. Within the tolerance it is static, if the surface was
  ///    fused from enough frames. Where the map does not say it, the tile moves if its place was
  ///    seen free, and is unexplained otherwise. A tile that is too close to be measured moves:
  ///    nothing static comes nearer to a hand-held camera than 0.12 m.
  /// 2. While the camera stands or sways, a tile that looks as the scene does is static whatever
  /// its
  ///    depth, and a tile without depth that has changed may move.
  /// 3. An unexplained tile moves if it continues the depth of what moves: a hand that reaches into
  ///    space which was never seen (tile_groups.h).
  /// 4. The border follows the edges of depth and look (mask_outline.h).
  ///
  /// @param world_from_camera  this frame's pose, or one predicted for it: it may be off by a tenth
  ///                           of MovingMaskSettings::step
  /// @param map                null: free space alone decides
  const MaskImage& find(const SeenFrame& seen, const Rigid3& world_from_camera,
                        const SurfaceMap* map);

  /// Of the depth's size: 255 where the last frame's depth is none of the pixel's own. It looks as
  /// the scene there does, and what was known of the scene's depth there is another one: the
  /// matcher took it over from what stands beside it, or found it by chance.
  [[nodiscard]] const MaskImage& borrowed() const { return borrowed_; }

  /// Learns from the frame of the last find(): through which cells it looked, and how the scene
  /// looks. Do not call it for a frame whose pose is not known.
  void learn(const Rigid3& world_from_camera);

  /// With what the look of the last frame was compared. If with anything, the scene is seen
  /// wherever nothing moves, also without a depth.
  [[nodiscard]] LookedAt looked_at() const {
    return compared_ == nullptr     ? LookedAt::kNothing
           : compared_ == &picture_ ? LookedAt::kPicture
                                    : LookedAt::kDrawnView;
  }

  /// The picture with which the last frame was compared; null unless looked_at() is kPicture.
  [[nodiscard]] const StaticPicture* picture() const {
    return compared_ == &picture_ ? compared_ : nullptr;
  }

  [[nodiscard]] const FreeSpace& space() const { return space_; }
  [[nodiscard]] const MovingMaskSettings& settings() const { return settings_; }

 private:
  // One look-up in map and free space, for `across` tiles from (i, j), and unless that is 1 for the
  // same ones of the next row:
  //
  //     across = 1   x      2   x x      4   x x x x
  //                             x x          x x x x
  struct LookUp {
    Eigen::Vector3f point;  // world, m
    const Voxel* voxel;     // of the map there, or null
    float depth;            // m
    int i, j;
    int across;
  };
  class Labeller;

  void resize(const DepthImage& depth);
  void sample(const SeenFrame& seen);
  void sample_other_places(const SeenFrame& seen, int i, int j);
  void find_smooth_squares(int j, int j1);
  void label(const Rigid3& world_from_camera, const SurfaceMap* map);
  void compare_look(const SeenFrame& seen, const Rigid3& world_from_camera);
  bool compare_with_picture(const SeenFrame& seen, const Rigid3& world_from_camera);
  void relabel_by_look(const StaticPicture& picture, bool is_starting, int i, int j);
  void relabel_without_depth(const StaticPicture& picture, int i, int j);
  void relabel_with_depth(const StaticPicture& picture, int i, int j);
  [[nodiscard]] bool is_borrowed(const StaticPicture& picture, int i, int j) const;
  void mark_borrowed(int i, int j);
  void find_ray_depths();

  DepthNoise noise_;
  MovingMaskSettings settings_;
  FreeSpace space_;
  std::pair<int, int> depth_size_;  // px, for which memory was allocated
  PinholeCamera depth_camera_;
  PinholeCamera tiles_;  // the camera whose pixels are the tiles
  DepthImage tile_depth_;
  Image<std::uint8_t> tile_label_;  // TileGroups::Label
  DepthImage ray_depth_;            // per 2 x 2 tiles the nearest depth, m
  std::vector<LookUp> look_ups_;    // of two rows of tiles
  // Of the tiles of a row, each with the one below it: least and largest depth, and their sum.
  std::vector<float> lowest_, highest_, sums_;
  std::vector<float> smooth_;  // per 2 x 2 tiles of two rows: the mean depth, or 0
  TileGroups groups_;
  Image<std::uint8_t> tile_moves_;  // 1 or 0
  MaskImage borrowed_;
  MaskOutline outline_;

  StaticPicture picture_;                     // for a camera that stands
  Rigid3 picture_pose_ = Rigid3::Identity();  // world_from_camera where it was taken
  int stood_;                                 // frames since it was begun
  SceneCanvas canvas_;                        // for a camera that sways
  StaticPicture drawn_;                       // compares frames with what the canvas draws
  PictureView view_;                          // what it draws
  bool moved_ = false;                        // whether anything moved in the last frame
  int compares_ = 0;                          // frames in which the camera stood or swayed
  const StaticPicture* compared_ = nullptr;   // &picture_, &drawn_, or null: this frame with none
  Image<std::uint8_t> tile_static_;           // not 0: the tile's depth is the scene's
};

}  // namespace palpable
