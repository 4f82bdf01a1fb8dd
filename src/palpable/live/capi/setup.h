/// @file
/// Conversion of a caller's setup and poses to the library's.
#pragma once

#include "palpable/common/geometry/frame.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/live/capi/palpable.h"
#include "palpable/live/session/session.h"

namespace palpable {

/// The settings of a session with a camera.
struct CameraSetup {
  FrameFormat format;
  SessionSettings session;
};

/// @param setup  as taken_in() returned it, with a camera
/// @throws Failure when a number is out of its range or the calibration file is invalid
[[nodiscard]] CameraSetup camera_setup(const palpable_setup& setup);

/// @param rows  16 numbers in the order that palpable.h states
/// @param name  of the argument, for the error message
/// @throws Failure when the matrix is not a rotation and a translation
[[nodiscard]] Rigid3 pose_of(const double* rows, const char* name);

/// The inverse of pose_of().
void write_pose(const Rigid3& pose, double rows[16]);

}  // namespace palpable
