/// @file
/// What palpable calibrate does: boards of a source, recorded or live, to a calibration file.
#pragma once

#include "palpable/calibrate/board_calibration.h"
#include "palpable/sources/camera_source.h"

#include <filesystem>
#include <string>

namespace palpable::app {

struct CalibrationTask {
  CameraRequest source;  ///< its calibration is left out; folders.front() keeps a camera's
  BoardPattern pattern;
  int views = 20;  ///< of a camera: boards to take
  BoardLimits limits;
  std::filesystem::path check;   ///< say how good this calibration is, and make none
  std::filesystem::path output;  ///< empty: a camera's is kept where palpable live finds it
  bool json = false;
};

struct CalibrationReport {
  std::string text;     ///< for stdout
  std::string refused;  ///< why the checked calibration is a bad one; empty when it is not
};

/// Looks at the source until it ends or, for a camera, until there are enough boards: one that is
/// nearly where another was teaches nothing and does not count. Progress and the camera's troubles
/// go to stderr.
/// @throws Error when the source cannot be opened, the file not be written (before anybody shows
///         boards), or the boards give no calibration that can be trusted
[[nodiscard]] CalibrationReport calibrate(const CalibrationTask& task, VideoSystem& system);

}  // namespace palpable::app
