/// @file
/// The map from outside as `live --view map` and `scan --picture` show it (the paper's Fig. 6): the
/// room, the way through it as a blue line, keyframes, the camera as it stands, the body.
#pragma once

#include "apps/palpable/camera_path.h"
#include "apps/palpable/follow_camera.h"
#include "palpable/map/map_mesher.h"
#include "palpable/render/map_renderer.h"
#include "palpable/session/session.h"
#include "palpable/track/tracker.h"

#include <Eigen/Core>

#include <vector>

namespace palpable::app {

/// The picture of a running session, frame by frame.
class MapPicture {
 public:
  /// @param world_from_body  the body's Z is up
  MapPicture(MapRenderer renderer, const Rigid3& world_from_body);

  /// Turns and zooms (follow_camera.h).
  void handle(const WindowEvent& event) { turned_ |= view_.handle(event); }

  /// The room is drawn anew in every third frame only, and when something is turned or the camera
  /// is lost or found: without a GPU it costs about as much as all else. Call it for every frame.
  /// @param scene   of the frame answered last; its touches and stress are on the body
  /// @param scale   Pa, top of the body's colours
  /// @param inside  what the camera sees, with the body: becomes a small picture in a corner
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
  int frames_ = 0;
  bool turned_ = false;
  bool was_known_ = true;
  ColorImage room_;  // the picture without what is written in it
  std::vector<MapLine> lines_;
  std::vector<MapPoint> points_;
};

/// The picture of what was scanned, 1280 x 720.
/// @param surface  of the whole room, not empty
/// @param keyframes  may be empty
[[nodiscard]] ColorImage picture_of_scan(MapRenderer& renderer, const MapMesh& surface,
                                         const CameraPath& path,
                                         const std::vector<KeyframePose>& keyframes,
                                         const PinholeCamera& camera);

}  // namespace palpable::app
