/// @file
/// Requests for cameras made of code (fake_video.h), and what becomes of those that are refused.
#pragma once

#include "palpable/live/sources/camera_source.h"
#include "tests/support/fake_video.h"
#include "tests/support/test.h"

#include <string>

namespace palpable::test {

/// A device without calibration.
inline CameraRequest camera_request(const char* device = "/dev/video0") {
  CameraRequest wanted;
  wanted.device = device;
  wanted.without_calibration = true;
  return wanted;
}

/// The message of a request that must be refused: one line, after which no device is open and no
/// buffer is mapped.
inline std::string camera_refusal(FakeVideo& video, const CameraRequest& wanted) {
  const auto result = open_camera(wanted, video);
  REQUIRE_FALSE(result.ok());
  CHECK(result.problem().message.find('\n') == std::string::npos);
  CHECK(video.opened == 0);
  CHECK(video.mapped == 0);
  return result.problem().message;
}

}  // namespace palpable::test
