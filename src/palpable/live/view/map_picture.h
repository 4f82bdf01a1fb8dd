/// @file
/// A picture of the map from outside (`live --view map`, `scan --picture`; the paper's Fig. 6): the
/// room, the camera's path as a blue line, key frames, the camera's present pose, the bodies.
#pragma once

#include "palpable/live/map/map_mesher.h"
#include "palpable/live/render/map_renderer.h"
#include "palpable/live/session/scene.h"
#include "palpable/live/session/session.h"
#include "palpable/live/track/tracker.h"
#include "palpable/live/view/camera_path.h"
#include "palpable/live/view/follow_camera.h"

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// The picture of a running session, frame by frame.
class MapPicture {
 public:
  /// @param world_from_body  pose of the first body, whose Z is up
  MapPicture(MapRenderer renderer, const Rigid3& world_from_body);

  /// Turns and zooms the view (follow_camera.h).
  void handle(const WindowEvent& event) { turned_ |= view_.handle(event); }

  /// Adds the camera's pose to its path; draw() does so, too. Call one of them for every frame.
  void follow(const Scene& scene);

  /// Draws the picture. The room is drawn anew only in every third frame, and when the view is
  /// turned or the camera is lost or found: without a GPU, drawing it takes about as long as
  /// everything else together.
  /// @param scene    the result of the last frame; its stress is painted on the bodies
  /// @param session  the one that made the scene, with its map, key frames and bodies
  /// @param scale    Pa, top of the bodies' colours
  /// @param colors   likewise
  /// @param inside   the camera's picture with the bodies, drawn as an inset
  /// @param picture  overwritten, as large as `inside`
  void draw(const Scene& scene, const Session& session, double scale, ColorScale colors,
            const ColorImage& inside, ColorImage& picture);

 private:
  void add_moving(const Scene& scene);
  void draw_room(const Scene& scene, const Session& session, double scale, ColorScale colors,
                 int width, int height);

  MapRenderer renderer_;
  FollowCamera view_;
  MapMesher mesher_;
  CameraPath path_;
  Eigen::Vector3d up_;
  std::vector<KeyframePose> keyframes_;
  int frames_ = 0;          // number of frames followed
  int next_drawn_ = 0;      // the room is drawn again when frames_ exceeds this,
  int next_keyframes_ = 0;  // and the key frames are copied again when it exceeds this
  bool turned_ = false;
  bool was_known_ = true;
  ColorImage room_;  // the picture without what is written in it
  std::vector<MapLine> lines_;
  std::vector<MapPoint> points_;
  std::vector<BodyLook> looks_;
};

/// Draws the picture of a scanned room, 1280 x 720.
/// @param surface    of the whole room, not empty
/// @param keyframes  may be empty
[[nodiscard]] ColorImage picture_of_scan(MapRenderer& renderer, const MapMesh& surface,
                                         const CameraPath& path,
                                         const std::vector<KeyframePose>& keyframes,
                                         const PinholeCamera& camera);

}  // namespace palpable
