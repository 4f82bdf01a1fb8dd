/// @file
/// The map from outside as `live --view map` and `scan --picture` show it (the paper's Fig. 6): the
/// room, the way through it as a blue line, keyframes, the camera as it stands, the bodies.
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
  /// @param world_from_body  of the first body, whose Z is up
  MapPicture(MapRenderer renderer, const Rigid3& world_from_body);

  /// Turns and zooms (follow_camera.h).
  void handle(const WindowEvent& event) { turned_ |= view_.handle(event); }

  /// Takes note of where the camera is; draw() does, too. Call one of them for every frame.
  void follow(const Scene& scene);

  /// The room is drawn anew in every third one only, and when the view is
  /// turned or the camera is lost or found: without a GPU that costs about as much as everything
  /// else.
  /// @param scene   of the frame answered last: its touches and stress are painted on the bodies
  /// @param session  that answered it: its map, keyframes and bodies
  /// @param scale   Pa, top of the bodies' colours
  /// @param inside  what the camera sees, with the bodies: it becomes a small picture in a corner
  /// @param picture overwritten, as large as `inside`
  void draw(const Scene& scene, const Session& session, double scale, const ColorImage& inside,
            ColorImage& picture);

 private:
  void add_moving(const Scene& scene);
  void draw_room(const Scene& scene, const Session& session, double scale, int width, int height);

  MapRenderer renderer_;
  FollowCamera view_;
  MapMesher mesher_;
  CameraPath path_;
  Eigen::Vector3d up_;
  std::vector<KeyframePose> keyframes_;
  int frames_ = 0;          // that were followed
  int next_drawn_ = 0;      // of these: from which on the room is due again,
  int next_keyframes_ = 0;  // and the keyframes
  bool turned_ = false;
  bool was_known_ = true;
  ColorImage room_;  // the picture without what is written in it
  std::vector<MapLine> lines_;
  std::vector<MapPoint> points_;
  std::vector<BodyLook> looks_;
};

/// The picture of what was scanned, 1280 x 720.
/// @param surface  of the whole room, not empty
/// @param keyframes  may be empty
[[nodiscard]] ColorImage picture_of_scan(MapRenderer& renderer, const MapMesh& surface,
                                         const CameraPath& path,
                                         const std::vector<KeyframePose>& keyframes,
                                         const PinholeCamera& camera);

}  // namespace palpable
