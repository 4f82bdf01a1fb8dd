/// @file
/// Conversion of a caller's setup to the library's.
#pragma once

#include "palpable/common/geometry/frame.h"
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

}  // namespace palpable
