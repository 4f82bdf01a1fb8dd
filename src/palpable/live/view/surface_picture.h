/// @file
/// A view from outside of the surface that contact uses near the bodies (`live --view surface`):
/// the points that the camera sees, the balls that stand for obstacles, and the pressed skins.
///
///     points in their own colours   everything seen near the bodies, the room included
///     green                         obstacles: the side that the camera sees
///     orange                        their other side, which is assumed
///     grey                          not seen at present, but held for a moment (held_balls.h)
#pragma once

#include "palpable/common/contact/pressing_surface.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/live/render/map_renderer.h"
#include "palpable/live/render/orbit_camera.h"
#include "palpable/live/render/window_events.h"
#include "palpable/live/session/scene.h"
#include "palpable/live/session/session.h"
#include "palpable/live/view/mouse_drag.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

/// Balls as one mesh for drawing: one sphere for each ball. Parts inside of other spheres are
/// hidden by them in the picture.
struct BallMesh {
  Eigen::Matrix3Xf vertices;   ///< (3 x N) m, body frame
  Eigen::Matrix3Xf normals;    ///< (3 x N) unit, outwards
  Eigen::Matrix3Xi triangles;  ///< (3 x M)
  std::vector<Rgb> colors;     ///< (N)
};

/// Makes the mesh.
/// @param camera_in_body  m, the camera's position: surfaces that face it were measured
/// @param mesh            overwritten; keeps its memory
void mesh_balls(std::span<const ObjectBall> balls, const Eigen::Vector3f& camera_in_body,
                BallMesh& mesh);

/// The picture of a running session, frame by frame.
class SurfacePicture {
 public:
  /// @param session  the bodies that the picture shows
  SurfacePicture(MapRenderer renderer, const Session& session);

  /// Any button turns the view (while several are held, the first one), the wheel zooms, R resets.
  void handle(const WindowEvent& event);

  /// @param scene    the result of the last frame
  /// @param session  the one that made the scene. It holds the balls that stand for the seen
  ///                 objects near each body
  /// @param scale    Pa, the stress of the last colour
  /// @param colors   of the bodies
  /// @param inside   the camera's picture with the bodies, drawn as an inset
  /// @param picture  overwritten, as large as `inside`
  void draw(const Scene& scene, const Session& session, double scale, ColorScale colors,
            const ColorImage& inside, ColorImage& picture);

 private:
  void add_points(const Scene& scene);
  void gather_balls(const Session& session);

  MapRenderer renderer_;
  // All in the first body's frame.
  Eigen::AlignedBox3d near_;  // seen points inside are drawn
  OrbitCamera usual_, orbit_;
  bool placed_ = false;  // whether the first picture has placed the eye beside the camera
  MouseDrag drag_;
  BallMesh mesh_;
  std::vector<MapPoint> points_;
  std::vector<ObjectBall> balls_;
  std::vector<BodyLook> looks_;
};

}  // namespace palpable
