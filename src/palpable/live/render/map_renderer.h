/// @file
/// Draws the map from outside (the paper's Fig. 6): the room's surface in its colours, the camera's
/// path as lines, the bodies, and moving things as points.
///
///   N  vertices     M  triangles
///
/// World frame, m.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/live/render/scene_renderer.h"

#include <Eigen/Core>

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace palpable {

/// The room's surface as plain arrays. Read during MapRenderer::set_surface() only.
struct MapSurface {
  const Eigen::Matrix3Xf* vertices = nullptr;   ///< (3 x N) m
  const Eigen::Matrix3Xf* normals = nullptr;    ///< (3 x N) unit, towards the seen side
  const Eigen::Matrix3Xi* triangles = nullptr;  ///< (3 x M) counter-clockwise from that side
  std::span<const Rgb> colors;                  ///< (N)
};

/// A straight line.
struct MapLine {
  Eigen::Vector3f from = Eigen::Vector3f::Zero();
  Eigen::Vector3f to = Eigen::Vector3f::Zero();
  Rgb color{};
  float width_px = 2;  ///< of the picture
};
/// A point, drawn as a small ball.
struct MapPoint {
  Eigen::Vector3f at = Eigen::Vector3f::Zero();
  float radius = 0.004f;  ///< m
  Rgb color{};
};

/// The content of one picture except the surface. Spans are read during draw() only.
struct MapView {
  PinholeCamera camera = {};  ///< of the picture
  Rigid3 camera_from_world = Rigid3::Identity();
  Eigen::Vector3d up = -Eigen::Vector3d::UnitY();  ///< unit; surfaces that face it are lighter
  std::span<const MapLine> lines = {};
  std::span<const MapPoint> points = {};
  std::span<const BodyLook> bodies = {};  ///< with camera_from_body of this view's camera
  /// The picture is drawn larger by this factor and averaged down: 1 for films, 2 for stills.
  int supersampling = 1;
};

/// Draws with the OpenGL context that is current now and in every later call. Itself allocates
/// nothing after a picture of the same sizes.
class MapRenderer {
 public:
  /// Needs a current context. The problem names shader and line.
  [[nodiscard]] static Result<MapRenderer> make();

  MapRenderer(MapRenderer&&) noexcept;
  MapRenderer& operator=(MapRenderer&&) noexcept;
  ~MapRenderer();

  /// Sets the room's surface for the next pictures.
  /// @throws ContractViolation when sizes do not match
  void set_surface(const MapSurface& surface);

  /// Draws `view`. Only the side from which a surface was seen is drawn, so that the near walls of
  /// a room do not hide its inside. Hidden parts of lines are drawn faintly.
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
