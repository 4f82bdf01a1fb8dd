// palpable calibrate: makes a calibration file from pictures of a chessboard, or measures the
// errors of a calibration file.

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/shared_options.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "palpable/common/base/output_file.h"
#include "palpable/live/sources/board_report.h"
#include "palpable/live/sources/calibrate_source.h"

#include <fmt/core.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

struct CalibrateOptions {
  SourceOptions source;
  BoardOptions board;
  int views = 20;
  BoardLimits limits;
  fs::path check;
  fs::path output;
  bool json = false;
};

// Shows the search in a bar and prints the source's messages on stderr.
std::function<void(const BoardSearchStep&)> shown_by(ProgressBar& bar) {
  return [&bar](const BoardSearchStep& step) {
    for (const std::string& line : step.reports) bar.say(line);
    if (!step.searched) return;
    bar.show({step.is_live ? "show the board, tilted to all sides" : "boards",
              static_cast<double>(step.done), static_cast<double>(step.total),
              fmt::format("{} boards", step.seen.views.size())});
  };
}

void check(const CalibrateOptions& options, const BoardOrder& order) {
  ProgressBar bar;
  const CheckedCalibration checked =
      check_calibration(order, options.check, linux_video(), shown_by(bar));
  bar.finish();
  const double rows = checked.row_error_px;
  const std::size_t boards = checked.seen.views.size();
  if (options.json) {
    const Json json = {{"pairs", checked.seen.pairs}, {"boards", boards}, {"row_error_px", rows}};
    fmt::print("{}\n", json.dump(2));
  } else {
    fmt::print("{} boards in {} pairs: rows after rectification {:.3f} px rms\n", boards,
               checked.seen.pairs, rows);
  }
  if (rows > options.limits.largest_row_error_px) {
    throw Error(fmt::format("{}: the rows are {:.2f} px apart; {:.2g} are allowed: calibrate again",
                            options.check.string(), rows, options.limits.largest_row_error_px));
  }
}

void calibrate(const CalibrateOptions& options) {
  const BoardOrder order{request_of(options.source), pattern_of(options.board), options.views,
                         options.limits};
  if (!options.check.empty()) {
    check(options, order);
    return;
  }
  if (options.output.empty() && !options.source.source.starts_with("/dev/")) {
    throw Error("-o is needed: the calibration file to write, e.g. -o calibration.yml");
  }
  if (!options.output.empty()) guard_output_file(options.output, inputs_of(options.source));
  ProgressBar bar;
  const CalibratedSource made =
      calibrate_source(order, options.output, linux_video(), shown_by(bar));
  bar.finish();
  if (options.json) {
    Json result = json_of(made.found, made.seen);
    result["file"] = made.file.string();
    fmt::print("{}\n", result.dump(2));
  } else {
    fmt::print("{}{}\n", text_of(made.found, made.seen, order.pattern), made.file.string());
  }
}

}  // namespace

void add_calibrate(Command app) {
  auto options = std::make_shared<CalibrateOptions>();
  Command command = app.add_subcommand(
      "calibrate",
      "Make a calibration file from pictures of a chessboard, or with a live stereo camera");
  command
      .add_option("--source", options->source.source,
                  "Stereo pairs of a board: a folder, images by name, a video file or /dev/videoN")
      .required();
  add_board_options(command, options->board);
  command.add_option("--views", options->views, "For a camera: pictures of the board to take")
      .in_range(3, 1000)
      .show_default();
  command
      .add_option("--largest-reprojection", options->limits.largest_reprojection_px,
                  "Refuse a calibration whose reprojection error is larger, px rms")
      .positive()
      .show_default();
  command
      .add_option("--largest-row-error", options->limits.largest_row_error_px,
                  "Refuse one whose two eyes' rows are farther apart, px rms")
      .positive()
      .show_default();
  command.add_flag("--accept", options->limits.accept_weak,
                   "Write a calibration although it has fewer than 6 boards (3 at least), boards "
                   "tilted by less than 15 degrees, or a focal length known to less than 1 %; how "
                   "well it is known is said");
  command.add_option("--check", options->check,
                     "Instead of calibrating: say how far this calibration leaves the two eyes' "
                     "rows apart on the boards");
  command
      .add_option("-o,--output", options->output,
                  "Calibration file to write (OpenCV YAML). Default for a camera: where palpable "
                  "live finds it")
      .excludes("--check");
  command.add_flag("--json", options->json, "One JSON object on stdout, all else on stderr");
  add_source_options(command, options->source, SourceKind::kRawStereo);
  command.footer(
      "A flat board with an odd and an even number of inner corners, shown 15 times or more, near "
      "enough to fill the picture and tilted to all sides.\n"
      "Example: palpable calibrate --source boards --board 9x6 --square 25 -o calibration.yml\n"
      "Example: palpable calibrate --source /dev/video0 --board 9x6 --square 25\n"
      "Example: palpable calibrate --source boards --square 25 --check SN10027514.conf");
  command.callback([options] { calibrate(*options); });
}

}  // namespace palpable::app
