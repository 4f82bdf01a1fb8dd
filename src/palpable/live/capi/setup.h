/// @file
/// A caller's setup and poses as those of the library.
#pragma once

#include "palpable/common/geometry/frame.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/live/capi/palpable.h"
#include "palpable/live/session/session.h"

namespace palpable {

/// Of a session with a camera.
struct CameraSetup {
  FrameFormat format;
  SessionSettings session;
};

/// @param setup  as taken_in(), of a camera
/// @throws Failure when a number is out of its range or the calibration file is none
[[nodiscard]] CameraSetup camera_setup(const palpable_setup& setup);

/// @param rows  16 numbers, as palpable.h has them
/// @param name  for the text
/// @throws Failure when they are no rotation and translation
[[nodiscard]] Rigid3 pose_of(const double* rows, const char* name);

/// The other way.
void write_pose(const Rigid3& pose, double rows[16]);

}  // namespace palpable
