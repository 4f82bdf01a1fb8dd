/// @file
/// Which part of a body is hidden when a session begins, by a hand over it or a cup before it. Such
/// an occluder counts as part of the room until its place has been seen free (anchored_scene.h), so
/// its touches there are not detected until then.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/live/depth/depth_noise.h"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace palpable {

/// For one body. Allocates nothing after the first frame.
class HiddenAtStart {
 public:
  /// Number of first frames in which a vertex can become hidden; later ones can only show it.
  static constexpr int kFrames = 5;

  /// Starts over: the next frame is the first one.
  void begin();

  /// Updates the hidden vertices. A vertex is hidden if the measured depth at its pixel is less
  /// than its own by more than 10 mm and by more than 4 sigma. It becomes visible for good as soon
  /// as a measured depth there is not less by that much: the camera then sees the desk behind the
  /// body, which is virtual. Pixels without depth, and vertices outside the picture, change
  /// nothing.
  /// @param vertices  (3 x V) m, body frame, at rest
  /// @return share of the vertices that were hidden in the first kFrames frames and ever since
  [[nodiscard]] double look(const DepthImage& depth, const PinholeCamera& camera,
                            const DepthNoise& noise, const Eigen::Matrix3Xd& vertices,
                            const Rigid3& camera_from_body);

 private:
  enum State : std::uint8_t { kUnknown, kHidden, kSeen };
  std::vector<State> states_;
  int frames_ = 0;
  int hidden_ = 0;  // vertices
};

}  // namespace palpable
