/// @file
/// Finds the pixels of a frame that show something that moves. Evidence for motion is a depth in
/// space that was seen free, a depth in front of the map's surface by more than the sensor's error,
/// or a missing depth together with a changed appearance.
///
///     sample()         takes one depth per tile
///     label()          labels each tile by map and free space (surface_map.h, free_space.h)
///     compare_look()   corrects labels by the tile's look     (static_picture.h, scene_canvas.h)
///     TileGroups       decides groups of neighbouring tiles   (tile_groups.h)
///     MaskOutline      refines tiles to pixels                (mask_outline.h)
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
  /// A depth agrees with the map when it lies at most max(step, sigmas * sigma_Z) in front of or
  /// behind the map's surface. Larger: flat things on the desk are missed; smaller: noise moves.
  double step = 0.015;  ///< m
  double sigmas = 4;
  /// Number of frames from which a surface must have been fused before a depth that agrees with it
  /// counts as static. With fewer frames it may be the surface of the hand itself.
  double frames_to_trust = 6;
  TileGroupSettings groups{};
  int grow_px = 4;   ///< how far the mask reaches into pixels of unknown depth at its border
  bool look = true;  ///< false: depth alone decides, to measure the benefit of comparing looks
};

/// The picture with which the look of a frame was compared.
enum class LookedAt {
  kNothing,    ///< none: the camera walks
  kDrawnView,  ///< a view drawn from the canvas, which may be a pixel off: the camera sways
  kPicture     ///< the static picture: the camera stands still
};

/// Finds the mask of each frame. Owns the free space, and the pictures of the scene for a camera
/// that stands still (static_picture.h) or sways (scene_canvas.h). Allocates only in its
/// constructor and at the first frame.
class MovingMask {
 public:
  /// @throws ContractViolation for settings out of their range
  MovingMask(const DepthNoise& noise, const MovingMaskSettings& settings = {});

  /// The mask of one frame: 255 where something moves, of the depth's size.
  ///
  /// 1. The depth in the middle of each tile is looked up in the map. If it lies in front of the
  ///    map's surface by more than the tolerance, the tile moves. Within the tolerance the tile is
  ///    static, provided that the surface was fused from enough frames. In all other cases the
  ///    tile moves if its point was seen free, and is unexplained otherwise. A tile that is too
  ///    close to be measured moves: nothing static comes closer than 0.12 m to a hand-held camera.
  /// 2. While the camera stands still or sways, a tile that looks like the scene is static whatever
  ///    its depth, and a tile without depth that has changed may move.
  /// 3. An unexplained tile moves if it continues the depth of moving tiles: a hand that reaches
  ///    into space that was never seen (tile_groups.h).
  /// 4. The border follows the edges of depth and look (mask_outline.h).
  ///
  /// @param world_from_camera  this frame's pose, or one predicted for it: it may be off by a tenth
  ///                           of MovingMaskSettings::step
  /// @param map                null: free space alone decides
  const MaskImage& find(const SeenFrame& seen, const Rigid3& world_from_camera,
                        const SurfaceMap* map);

  /// A mask of the depth's size: 255 where the last frame's depth does not belong to the pixel. The
  /// pixel looks like the scene, but the known depth of the scene there is a different one, so the
  /// matcher has copied the depth from a neighbouring object or found it by chance.
  [[nodiscard]] const MaskImage& borrowed() const { return borrowed_; }

  /// Updates free space and the pictures of the scene from the frame of the last find(). Do not
  /// call it for a frame whose pose is not known.
  void learn(const Rigid3& world_from_camera);

  /// The picture with which the look of the last frame was compared. Unless it is kNothing, every
  /// pixel that does not move is known to show the scene, even one without a depth.
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
  // One look-up in map and free space. It serves `across` tiles beginning at (i, j) and, unless
  // across is 1, the same columns of the next row (x: tiles served):
  //
  //     across = 1   x      2   x x      4   x x x x
  //                             x x          x x x x
  struct LookUp {
    Eigen::Vector3f point;  // world, m
    const Voxel* voxel;     // the map's voxel at the point, or null
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
  // Per tile of a row, together with the tile below it: least and largest depth, and their sum.
  std::vector<float> lowest_, highest_, sums_;
  std::vector<float> smooth_;  // per 2 x 2 tiles of two rows: mean depth, or 0 if not smooth
  TileGroups groups_;
  Image<std::uint8_t> tile_moves_;  // 1 or 0
  MaskImage borrowed_;
  MaskOutline outline_;

  StaticPicture picture_;                     // for a camera that stands still
  Rigid3 picture_pose_ = Rigid3::Identity();  // world_from_camera of picture_
  int stood_;                                 // frames since the camera reached picture_pose_
  SceneCanvas canvas_;                        // for a camera that sways
  StaticPicture drawn_;                       // compares frames with view_
  PictureView view_;                          // the view that the canvas has drawn
  bool moved_ = false;                        // whether anything moved in the last frame
  int compares_ = 0;                          // frames in which the camera stood still or swayed
  const StaticPicture* compared_ = nullptr;   // in this frame: &picture_, &drawn_, or null: none
  Image<std::uint8_t> tile_static_;           // not 0: the tile's depth is the scene's
};

}  // namespace palpable
