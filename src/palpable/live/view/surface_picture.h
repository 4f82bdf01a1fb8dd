/// @file
/// What contact knows of the real world near bodies, from outside (`live --view surface`): the
/// points that the camera sees, the balls behind them, and the pressed skins.
///
///     points in their own colours   what is seen near the body, the room too
///     green                         the things that press: the side that is seen
///     orange                        their other side, which is assumed
///     grey                          not seen at present: held for a moment (held_balls.h)
#pragma once

#include "palpable/common/contact/object_ball.h"
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

/// The balls as one mesh that is drawn: a sphere each; what lies inside others is hidden by them.
struct BallMesh {
  Eigen::Matrix3Xf vertices;   ///< (3 x N) m, body frame
  Eigen::Matrix3Xf normals;    ///< (3 x N) unit, outwards
  Eigen::Matrix3Xi triangles;  ///< (3 x M)
  std::vector<Rgb> colors;     ///< (N)
};

/// @param camera_in_body  where the camera stands: what faces it is measured
/// @param mesh            overwritten; keeps its memory
void mesh_balls(std::span<const ObjectBall> balls, const Eigen::Vector3f& camera_in_body,
                BallMesh& mesh);

/// The picture of a running session, frame by frame.
class SurfacePicture {
 public:
  /// @param session  whose bodies it looks at
  SurfacePicture(MapRenderer renderer, const Session& session);

  /// Any button turns (of several the first one), the wheel zooms, R takes both back.
  void handle(const WindowEvent& event);

  /// @param scene    of the frame answered last
  /// @param session  that answered it: of each body the balls near it
  /// @param scale    Pa, top of the bodies' colours
  /// @param inside   what the camera sees, with the bodies: it becomes a small picture in a corner
  /// @param picture  overwritten, as large as `inside`
  void draw(const Scene& scene, const Session& session, double scale, const ColorImage& inside,
            ColorImage& picture);

 private:
  void add_points(const Scene& scene);
  void gather_balls(const Session& session);

  MapRenderer renderer_;
  // All in the first body's frame.
  Eigen::AlignedBox3d near_;  // what of the seen points is drawn
  OrbitCamera usual_, orbit_;
  bool placed_ = false;  // the first picture looks from beside the camera
  MouseDrag drag_;
  BallMesh mesh_;
  std::vector<MapPoint> points_;
  std::vector<ObjectBall> balls_;
  std::vector<BodyLook> looks_;
};

}  // namespace palpable
