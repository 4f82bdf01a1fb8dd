/// @file
/// The way of a camera through a room, for pictures of it.
#pragma once

#include "palpable/geometry/rigid.h"
#include "palpable/render/map_renderer.h"
#include "palpable/track/tracker.h"

#include <optional>
#include <vector>

namespace palpable::app {

/// Where the camera has been: one point every centimetre, a gap where it was lost or a loop was
/// closed. What came before the loop stays where it was thought to be. Of a way of more than 4,096
/// points every second one goes, and those to come are twice as far apart.
class CameraPath {
 public:
  void add(const TrackedPose& camera);
  /// Adds the way as lines, up to where the camera is now.
  void draw(std::vector<MapLine>& lines) const;
  /// Poses along it, one for each point.
  [[nodiscard]] const std::vector<Rigid3>& poses() const { return poses_; }

 private:
  void thin();

  double step_ = 0.01;           // m between two points
  std::vector<Rigid3> poses_;    // world_from_camera
  std::vector<bool> continues_;  // the way leads here from the one before
  std::optional<Rigid3> now_;    // nothing while the camera is lost
};

}  // namespace palpable::app
