// palpable calibrate: pictures of a chessboard to a calibration file, or a file's errors on them.

#include "apps/common/command_line.h"
#include "apps/palpable/board_options.h"
#include "apps/palpable/calibration_run.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/source_options.h"
#include "palpable/base/error.h"

#include <fmt/core.h>

#include <filesystem>
#include <memory>

namespace palpable::app {
namespace {

struct Options {
  SourceOptions source;
  BoardOptions board;
  int views = 20;
  BoardLimits limits;
  std::filesystem::path check;
  std::filesystem::path output;
  bool json = false;
};

CalibrationTask task_of(const Options& options) {
  return {request_of(options.source),
          pattern_of(options.board),
          options.views,
          options.limits,
          options.check,
          options.output,
          options.json};
}

}  // namespace

void add_calibrate(Command app) {
  auto options = std::make_shared<Options>();
  Command command = app.add_subcommand(
      "calibrate", "Pictures of a chessboard, or a live stereo camera, to a calibration file");
  command
      .add_option("--source", options->source.source,
                  "Stereo pairs of a board: a folder, images by name, a video file or /dev/videoN")
      .required();
  add_board_options(command, options->board);
  command.add_option("--views", options->views, "Of a camera: boards to take")
      .in_range(6, 1000)
      .show_default();
  command
      .add_option("--largest-reprojection", options->limits.largest_reprojection_px,
                  "Refuse above this, px rms")
      .show_default();
  command
      .add_option("--largest-row-error", options->limits.largest_row_error_px,
                  "Refuse above this, px rms")
      .show_default();
  command.add_option("--check", options->check,
                     "Make none; say how far this calibration's rows are apart on the boards");
  command
      .add_option("-o,--output", options->output,
                  "Calibration file (OpenCV YAML). Default for a camera: where palpable live "
                  "finds it")
      .excludes("--check");
  command.add_flag("--json", options->json, "One JSON object on stdout, all else on stderr");
  add_source_options(command, options->source, SourceKind::kRawStereo);
  command.footer(
      "A flat board with an odd and an even number of inner corners, shown 15 times or more, near\n"
      "enough to fill the picture and tilted to all sides.\n"
      "Example: palpable calibrate --source boards --board 9x6 --square 25 -o calibration.yml\n"
      "Example: palpable calibrate --source /dev/video0 --board 9x6 --square 25\n"
      "Example: palpable calibrate --source boards --square 25 --check SN10027514.conf");
  command.callback([options] {
    const CalibrationReport report = calibrate(task_of(*options), linux_video());
    fmt::print("{}", report.text);
    if (!report.refused.empty()) throw Error(report.refused);
  });
}

}  // namespace palpable::app
