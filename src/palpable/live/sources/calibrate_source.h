/// @file
/// A stereo source that shows a chessboard, recorded or live, to a calibration file.
#pragma once

#include "palpable/live/calibrate/board_calibration.h"
#include "palpable/live/sources/camera_source.h"
#include "palpable/live/sources/seen_boards.h"

#include <filesystem>
#include <functional>

namespace palpable {

/// The boards that are looked at.
struct BoardOrder {
  CameraRequest source;  ///< its calibration is left out; folders.front() keeps a camera's
  BoardPattern pattern;
  int views = 20;  ///< of a camera: boards to take
  BoardLimits limits;
};

struct CalibratedSource {
  SeenBoards seen;
  BoardCalibration found;
  std::filesystem::path file;  ///< written
};

/// Looks at the source until it ends or, for a camera, until there are enough boards
/// (seen_boards.h), and writes the rig's calibration.
/// @param file  to write; empty: a camera's is kept where `palpable live` looks for it
/// @throws Error when the source cannot be opened, the file not be written (said before anybody
///         shows boards), or the boards give no calibration that can be trusted
[[nodiscard]] CalibratedSource calibrate_source(
    const BoardOrder& order, const std::filesystem::path& file, VideoSystem& system,
    const std::function<void(const BoardSearchStep&)>& on_step);

struct CheckedCalibration {
  SeenBoards seen;
  double row_error_px = 0;  ///< rms of the corners' rows once the calibration has rectified them
};

/// How good a calibration is on boards that it may never have seen.
/// @throws Error when the source or the file cannot be read, when the file is of another size or no
///         raw stereo rig's, or when no board was seen
[[nodiscard]] CheckedCalibration check_calibration(
    const BoardOrder& order, const std::filesystem::path& file, VideoSystem& system,
    const std::function<void(const BoardSearchStep&)>& on_step);

}  // namespace palpable
