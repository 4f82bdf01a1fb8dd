/// @file
/// The map seen from outside (the paper's Fig. 6): the room's surface in its colours, lines for
/// where the camera has been, bodies where they stand, points for what moves.
///
///   N  vertices     M  triangles
///
/// World frame, m.
#pragma once

#include "palpable/base/error.h"
#include "palpable/geometry/camera.h"
#include "palpable/geometry/image.h"
#include "palpable/render/scene_renderer.h"

#include <Eigen/Core>

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace palpable {

/// The room's surface as plain arrays; read by MapRenderer::set_surface only.
struct MapSurface {
  const Eigen::Matrix3Xf* vertices = nullptr;   ///< (3 x N) m
  const Eigen::Matrix3Xf* normals = nullptr;    ///< (3 x N) unit, to the side it was seen from
  const Eigen::Matrix3Xi* triangles = nullptr;  ///< (3 x M) counter-clockwise from that side
  std::span<const Rgb> colors;                  ///< (N)
};

/// A stretch of line, and a point (drawn as a small ball).
struct MapLine {
  Eigen::Vector3f from = Eigen::Vector3f::Zero();
  Eigen::Vector3f to = Eigen::Vector3f::Zero();
  Rgb color{};
  float width_px = 2;  ///< of the picture
};
struct MapPoint {
  Eigen::Vector3f at = Eigen::Vector3f::Zero();
  float radius = 0.004f;  ///< m
  Rgb color{};
};

/// All that one picture shows beside the surface. Spans are read during draw() only.
struct MapView {
  PinholeCamera camera = {};  ///< of the picture
  Rigid3 camera_from_world = Rigid3::Identity();
  Eigen::Vector3d up = -Eigen::Vector3d::UnitY();  ///< unit; what faces it is a little lighter
  std::span<const MapLine> lines = {};
  std::span<const MapPoint> points = {};
  std::span<const BodyLook> bodies = {};  ///< their camera_from_body is of this view's camera
  /// Drawn so many times as large and averaged: 1 for pictures that move, 2 for one that is kept.
  int supersampling = 1;
};

/// Draws with the OpenGL context that is current now and in every later call. Allocates nothing on
/// our side once sizes are known.
class MapRenderer {
 public:
  /// Needs a current context. The problem names shader and line.
  [[nodiscard]] static Result<MapRenderer> make();

  MapRenderer(MapRenderer&&) noexcept;
  MapRenderer& operator=(MapRenderer&&) noexcept;
  ~MapRenderer();

  /// What the next pictures show as the room.
  /// @throws ContractViolation when sizes do not match
  void set_surface(const MapSurface& surface);

  /// Draws `view`. A surface is seen from the side from which the camera saw it: walls between it
  /// and the eye are left out, so that one looks into a room from outside. Lines shine faintly
  /// through what hides them.
  /// @param picture  overwritten, camera size
  void draw(const MapView& view, ColorImage& picture);

 private:
  struct State;
  explicit MapRenderer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Adds the outline of a camera: its four rays up to `depth` m and the rectangle they end in.
void add_frustum(std::vector<MapLine>& lines, const PinholeCamera& camera,
                 const Rigid3& world_from_camera, double depth, Rgb color, float width_px);

}  // namespace palpable
