/// @file
/// A picture of the static scene for a camera that sways, as a hand-held camera always does. It
/// stores how the scene looks from one pose, with the depth of each tile, and from that draws how
/// the scene should look in a frame from a nearby pose. StaticPicture compares the frame with that
/// view.
///
///   key   the camera's pose when the canvas was begun
///   tile  a square of 4 x 4 pixels of the depth image
///
/// The canvas is the depth image enlarged by a margin on all sides, for parts of the scene that
/// come into view when the camera turns; depths are in m, in the key's frame.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/live/map/static_picture.h"

#include <cstdint>
#include <vector>

namespace palpable {

struct SceneCanvasSettings {
  int margin = 24;  ///< tiles on each side, >= 0
  /// m. The canvas is begun anew when the camera's motion since the key shifts an object at this
  /// distance by the whole margin in the picture. Smaller: the canvas is begun anew more often.
  double distance = 0.5;
  /// Frames that the camera must stay near a key before it counts as swaying. For a camera that
  /// walks no canvas is drawn, which saves its cost.
  int frames_to_stay = 15;
};

class SceneCanvas {
 public:
  /// @throws ContractViolation for settings out of their range
  explicit SceneCanvas(const SceneCanvasSettings& settings = {});

  /// Begins the canvas anew when the camera has left the key's surroundings. Call it once a frame;
  /// it allocates at the first frame of a size.
  void follow(const PinholeCamera& depth_camera, const Rigid3& world_from_camera);

  /// Whether the camera has been near the key for long enough.
  [[nodiscard]] bool stays() const { return stayed_ >= settings_.frames_to_stay; }

  /// Draws the scene as a frame from this pose should show it. Each tile of the canvas is shifted
  /// by whole pixels according to its depth; nearer tiles cover farther ones. A gap of one tile is
  /// filled with the shift of the tile at its left or above it.
  /// @param view  of the frame's size; is overwritten
  void draw(const Rigid3& world_from_camera, PictureView& view);

  /// Copies tiles of a frame onto parts of the canvas that are still empty. Only tiles whose depth
  /// is the scene's and at which or beside which nothing moves are copied. A tile of the canvas
  /// does not change until the canvas is begun anew. Each frame visits a quarter of the tiles, and
  /// the next three frames visit the others.
  /// @param picture     the object that has compared the frame
  /// @param tile_depth  m, per tile of the frame
  /// @param is_static   per tile: not 0 where that depth is the scene's
  /// @param moves       per tile: not 0 where it or a neighbour moves
  void learn(const Rigid3& world_from_camera, const StaticPicture& picture,
             const DepthImage& tile_depth, const Image<std::uint8_t>& is_static,
             const Image<std::uint8_t>& moves);

 private:
  // The source of a tile of the frame: the canvas's tile (i, j), at an offset of (dx, dy) px;
  // i < 0: there is none.
  struct Source {
    std::int16_t dx = 0, dy = 0, i = -1, j = 0;
  };
  // Where the tiles of one row of the canvas land in the frame: in tile (a, b) at depth Z, moved by
  // (-dx, -dy) px.
  struct Landings {
    std::vector<float> Z;
    std::vector<std::int32_t> a, b, dx, dy;
  };
  void resize(const PinholeCamera& camera);
  [[nodiscard]] bool holds(int x, int y) const;
  void prefetch_row(int j, const Source& like) const;
  void find_sources(const Rigid3& world_from_camera);
  void put_onto(int a, int b, const GrayImage& from, int x, int y, const TileColor& color, float Z);

  SceneCanvasSettings settings_;
  PinholeCamera camera_;
  Rigid3 world_from_key_ = Rigid3::Identity();
  int stayed_ = 0;  // frames since the canvas was begun; 0: there is none
  int frame_ = 0;   // calls of learn()
  GrayImage luma_;
  Image<TileColor> colors_;
  DepthImage depth_;       // per tile; NaN: nothing is known
  Image<Source> sources_;  // per tile of the frame
  DepthImage nearest_;     // per tile of the frame: Z of its source
  Landings landing_;
};

}  // namespace palpable
