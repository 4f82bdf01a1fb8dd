/// @file
/// Options that several commands share: the source of images (live, scan, calibrate), the
/// chessboard (live, calibrate), what is painted (live, replay, view), loads (view, press).
#pragma once

#include "palpable/common/reduced/loaded_body.h"
#include "palpable/live/calibrate/board_calibration.h"
#include "palpable/live/sources/camera_source.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpable::app {

class Command;

struct SourceOptions {
  std::string source;                ///< folder, images by name, video file or /dev/video*
  std::string right;                 ///< the right eye's; empty: `source` has both eyes
  std::string depth_source;          ///< a depth camera or depth images by name; empty: stereo
  std::optional<double> depth_unit;  ///< m per step of depth images; empty: as they state it
  std::string stereo_size;           ///< one of kDepthSizes; empty: the first
  double farthest = 0;               ///< m; 0: the command's default
  std::filesystem::path calibration;
  std::string size;  ///< "2560x720"; empty: automatic choice
  double frames_per_second = 0;
  double exposure_ms = 0;  ///< 0: automatic
  double gain = -1;        ///< negative: automatic
  bool lock_exposure = false;
  bool baseline_ok = false;
};

/// The command that options are for. It decides which there are, and which of them only --help-all
/// lists.
enum class SourceOptionsFor {
  kScan,
  kCalibrate,  ///< raw stereo only: without depth and without --calibration
  kLive,       ///< only --right and --calibration are listed by --help
};

/// Adds `source` as an argument and as the option --source; it is required.
/// @param what  the command's own words for it
void add_source_argument(Command command, SourceOptions& options, const std::string& what);

/// Adds all other options of the source, under headings of their own.
void add_source_options(Command command, SourceOptions& options, SourceOptionsFor use);

/// The request for open_source(). @throws Error when --size is invalid
[[nodiscard]] CameraRequest request_of(const SourceOptions& options);

/// The files, folders and images by name that the options name, as they are given.
[[nodiscard]] std::vector<std::filesystem::path> named_inputs(const SourceOptions& options);

/// The same as files and folders, which outputs must not replace: for images by name their folder.
[[nodiscard]] std::vector<std::filesystem::path> inputs_of(const SourceOptions& options);

/// Options that describe a chessboard.
struct BoardOptions {
  std::string corners = "9x6";
  double square = 0.025;  ///< m, side of one of its squares
};

/// Adds --board and --square, in kLive for --help-all only.
void add_board_options(Command command, BoardOptions& options,
                       SourceOptionsFor use = SourceOptionsFor::kLive);

/// @throws Error when --board is invalid
[[nodiscard]] BoardPattern pattern_of(const BoardOptions& options);

/// Adds the options --paint and --colors. Their defaults are the values that the two variables have
/// at this call.
/// @param paint   receives one of kPaints' names (view/show_names.h)
/// @param colors  one of kColorScaleNames
void add_paint_options(Command command, std::string& paint, std::string& colors);

/// Parses texts "X,Y,Z=F": m in the body's frame, N. @throws Error for another form,
/// and as load_at()
[[nodiscard]] std::vector<PlacedLoad> parse_loads(const ReducedBody& body,
                                                  const std::vector<std::string>& texts);

}  // namespace palpable::app
