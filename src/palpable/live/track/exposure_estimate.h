/// @file
/// Estimates how long the shutter is open. While the camera moves fast, its picture is smeared by
/// the motion during that time, and a patch is only found if its template is smeared equally.
#pragma once

#include "palpable/live/track/pose_search.h"

namespace palpable {

class ExposureEstimate {
 public:
  /// Share of the frame time during which the shutter is open; 0 until it was measured.
  [[nodiscard]] double share() const { return share_; }

  /// Measures the share in a frame in which the picture has moved far: the result is the one of six
  /// shares whose smear makes the landmarks' templates most similar to the picture. The first
  /// result is taken over fully; afterwards every fourth frame is measured and averaged in with
  /// weight 0.3. Changes nothing if fewer than 8 landmarks can be compared.
  /// @param seen         the search that found the frame's pose, with its inliers
  /// @param frame_count  frames so far
  void measure(const LandmarkSearch& search, const PoseSearch& seen,
               const Rigid3& camera_from_world, const Rigid3& previous_from_world, int frame_count);

 private:
  double share_ = 0;
  bool known_ = false;
};

}  // namespace palpable
