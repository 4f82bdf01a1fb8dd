/// @file
/// Calibrates a stereo source, recorded or live, from pictures of a chessboard.
#pragma once

#include "palpable/live/calibrate/board_calibration.h"
#include "palpable/live/sources/camera_source.h"
#include "palpable/live/sources/seen_boards.h"

#include <filesystem>
#include <functional>

namespace palpable {

/// What to search for, and where.
struct BoardOrder {
  /// Its calibration is ignored; folders.front() receives a camera's. Its rule of baselines is that
  /// for the rig that is made or checked.
  CameraRequest source;
  BoardPattern pattern;
  int views = 20;  ///< of a camera: number of boards to find
  BoardLimits limits;
  /// Folder for the calibration as other programs read it (exported_calibration.h); empty: none.
  std::filesystem::path export_folder = {};
};

struct CalibratedSource {
  SeenBoards seen;
  BoardCalibration found;
  std::filesystem::path file;  ///< the file that was written
};

/// Searches the source until it ends or, for a camera, until there are enough boards
/// (seen_boards.h), and writes the rig's calibration.
/// @param file  to write; empty: for a camera, the file that `palpable live` looks for
/// @throws Error when the source cannot be opened, when the file cannot be written (reported before
/// the first board is shown), or when the boards give no reliable calibration or an unlikely
/// baseline
[[nodiscard]] CalibratedSource calibrate_source(
    const BoardOrder& order, const std::filesystem::path& file, VideoSystem& system,
    const std::function<void(const BoardSearchStep&)>& on_step);

struct CheckedCalibration {
  SeenBoards seen;
  double row_error_px = 0;  ///< rms row difference of the rectified corners
  double baseline = 0;      ///< m, of the file
};

/// Measures the error of a calibration with boards that need not be those of the calibration.
/// @throws Error when the source or the file cannot be read, when the file is for another size or
/// not for a raw stereo rig, or when no board was found
[[nodiscard]] CheckedCalibration check_calibration(
    const BoardOrder& order, const std::filesystem::path& file, VideoSystem& system,
    const std::function<void(const BoardSearchStep&)>& on_step);

}  // namespace palpable
