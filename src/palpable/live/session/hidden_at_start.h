/// @file
/// Which part of a body is hidden as a session begins: a hand lies over it, a cup stands before it.
/// What hides it is taken for the room until its place has been seen free (anchored_scene.h), so a
/// touch of it there is not felt until then.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/live/depth/depth_noise.h"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace palpable {

/// Of one body. Allocates nothing after the first frame.
class HiddenAtStart {
 public:
  /// Frames in which a part may be found hidden; later ones can only show it.
  static constexpr int kFrames = 5;

  /// Forgets all: the next frame is the first one.
  void begin();

  /// A vertex is hidden where something is measured more than 10 mm and 4 sigma before it, and no
  /// longer once something is measured there that is not: the desk behind, say, which the camera
  /// sees through the body. What has no depth or is beside the picture says nothing.
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
