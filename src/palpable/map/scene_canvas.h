/// @file
/// What a camera that sways has seen of the static scene, kept as it looked from one place, so that
/// it can be drawn as any frame from near that place should show it.
///
///   key   the place: the pose at which the canvas was begun
///   tile  a square of 4 x 4 pixels of the depth image
///
/// Everything is of the depth image's size with a margin on all sides; depths in m, key's frame.
#pragma once

#include "palpable/geometry/camera.h"
#include "palpable/geometry/image.h"
#include "palpable/geometry/rigid.h"
#include "palpable/map/static_picture.h"

#include <cstdint>
#include <vector>

namespace palpable {

struct SceneCanvasSettings {
  int margin = 24;  ///< tiles on each side, >= 0
  /// It is begun anew when the camera has gone so far that what is so far away, m, has left the
  /// margin.
  double distance = 0.5;
  /// Nothing is kept before the camera has stayed for so many frames: one that walks needs none.
  int frames_to_stay = 15;
  /// A tile whose depth is the scene's but whose look is not is forgotten when it was seen so often
  /// in a row; 1 .. 255.
  int visits_to_renew = 6;
};

class SceneCanvas {
 public:
  /// @throws ContractViolation for settings out of their range
  explicit SceneCanvas(const SceneCanvasSettings& settings = {});

  /// Call it once a frame. Takes memory at the first one of a size.
  void follow(const PinholeCamera& depth_camera, const Rigid3& world_from_camera);

  /// The camera has been near the key for long enough.
  [[nodiscard]] bool stays() const { return stayed_ >= settings_.frames_to_stay; }

  /// The scene as a frame from there shows it: each tile of the canvas goes where its depth says,
  /// by whole pixels; the nearer covers the farther. A gap of one tile is closed.
  /// @param view  of the frame's size, filled
  void draw(const Rigid3& world_from_camera, PictureView& view);

  /// Takes in the tiles of a frame whose depth is the scene's and that are not known or, for a
  /// while, look otherwise; a quarter of them, in the next frames the others.
  /// @param picture     that compared the frame
  /// @param tile_depth  m, per tile of the frame
  /// @param is_static   per tile: not 0 where that depth is the scene's
  /// @param moves       per tile: not 0 where something moves, or may
  void learn(const Rigid3& world_from_camera, const StaticPicture& picture,
             const DepthImage& tile_depth, const Image<std::uint8_t>& is_static,
             const Image<std::uint8_t>& moves);

 private:
  struct Source {  // of a tile of the frame
    std::int16_t dx = 0, dy = 0, i = -1, j = 0;
  };
  struct Landings {  // of a row of the canvas: tile (a, b) of the frame, and how far from there
    std::vector<float> Z;
    std::vector<std::int32_t> a, b, dx, dy;
  };
  void resize(const PinholeCamera& camera);
  [[nodiscard]] bool holds(int x, int y) const;
  void fetch_row(int j, const Source& like) const;
  void find_sources(const Rigid3& world_from_camera);

  SceneCanvasSettings settings_;
  PinholeCamera camera_;
  Rigid3 world_from_key_ = Rigid3::Identity();
  int stayed_ = 0, frame_ = 0;
  GrayImage luma_;
  Image<TileColor> colors_;
  DepthImage depth_;             // of the tiles; NaN: not known
  Image<std::uint8_t> strange_;  // visits in a row
  Image<Source> sources_;        // of a frame's tiles
  DepthImage nearest_;
  Landings landing_;
};

}  // namespace palpable
