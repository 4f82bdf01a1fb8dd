/// @file
/// A picture of the static scene for a camera that sways, as one in a hand always does. It holds
/// how the scene looks from one place, with the depth of each tile, and draws from that how a frame
/// from near the place should show the scene. StaticPicture compares the frame with that view.
///
///   key   the camera's pose when the canvas was begun: the place
///   tile  a square of 4 x 4 pixels of the depth image
///
/// The canvas has the depth image's size and a margin on all sides, for what comes into view when
/// the camera turns; depths are in m, in the key's frame.
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
  /// m. The canvas is begun anew when the camera has moved so far from the key that a thing at this
  /// distance has moved through the whole margin.
  double distance = 0.5;
  /// Frames that the camera must stay near a key before it counts as swaying: a camera that walks
  /// needs no canvas, and should not pay for one.
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

  /// Draws the scene as a frame from this pose should show it. Each tile of the canvas goes where
  /// its depth says, by whole pixels; a nearer one covers a farther one. A gap of one tile is
  /// filled as if it belonged to the tile at its left or above it.
  /// @param view  of the frame's size; is overwritten
  void draw(const Rigid3& world_from_camera, PictureView& view);

  /// Learns from the tiles of a frame whose depth is the scene's and beside which nothing moves:
  /// puts those that are not known yet onto the canvas. What is on it stays until the canvas is
  /// begun anew. Each frame looks at a quarter of the tiles, the next three at the others.
  /// @param picture     the one that compared the frame
  /// @param tile_depth  m, per tile of the frame
  /// @param is_static   per tile: not 0 where that depth is the scene's
  /// @param moves       per tile: not 0 where something moves, or beside that
  void learn(const Rigid3& world_from_camera, const StaticPicture& picture,
             const DepthImage& tile_depth, const Image<std::uint8_t>& is_static,
             const Image<std::uint8_t>& moves);

 private:
  // From where a tile of the frame is drawn: the canvas's tile (i, j), moved by (dx, dy) px; i < 0:
  // from nowhere.
  struct Source {
    std::int16_t dx = 0, dy = 0, i = -1, j = 0;
  };
  // Where a row of the canvas's tiles comes to lie: at depth Z in tile (a, b) of the frame, moved
  // by
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
  int stayed_ = 0;  // frames since the canvas was begun; 0: it is not
  int frame_ = 0;   // frames from which it has learnt
  GrayImage luma_;
  Image<TileColor> colors_;
  DepthImage depth_;       // per tile; NaN: nothing is known
  Image<Source> sources_;  // per tile of the frame
  DepthImage nearest_;     // per tile of the frame: Z of its source
  Landings landing_;
};

}  // namespace palpable
