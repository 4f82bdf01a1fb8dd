/// @file
/// How long the shutter is open: while the camera moves fast, its picture is smeared by the motion
/// of that time, and a patch is only found when it is smeared alike.
#pragma once

#include "palpable/live/track/pose_search.h"

namespace palpable {

class ExposureEstimate {
 public:
  /// Share of the frame time that the shutter is open; 0 until it was measured.
  [[nodiscard]] double share() const { return share_; }

  /// Measures it in a frame in which the picture has moved far: of six shares the one whose smear
  /// makes the landmarks' patches most like what is seen. Changes nothing when fewer than 8
  /// landmarks can be compared. The first time it counts fully, then in every fourth frame by 0.3.
  /// @param seen         the frame's pose and the landmarks that carried it
  /// @param frame_count  frames so far
  void measure(const LandmarkSearch& search, const PoseSearch& seen,
               const Rigid3& camera_from_world, const Rigid3& previous_from_world, int frame_count);

 private:
  double share_ = 0;
  bool known_ = false;
};

}  // namespace palpable
