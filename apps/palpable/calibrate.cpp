// palpable calibrate: makes a calibration file from pictures of a chessboard, or measures the
// errors of a calibration file.

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/shared_options.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/output_name.h"
#include "palpable/live/calibrate/calibration_check.h"
#include "palpable/live/calibrate/exported_calibration.h"
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
  int boards = 20;
  BoardLimits limits;
  fs::path check;
  fs::path out;
  fs::path export_folder;
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
    print_json({{"pairs", checked.seen.pairs},
                {"boards", boards},
                {"baseline_m", checked.baseline},
                {"row_error_px", rows}});
  } else {
    print_text("{} boards in {} pairs: rows after rectification {:.3f} px rms; baseline {}\n",
               boards, checked.seen.pairs, rows, baseline_text(checked.baseline));
  }
  if (rows > options.limits.largest_row_error_px) {
    throw Error(fmt::format("{}: the rows are {:.2f} px apart; {:.2g} are allowed: calibrate again",
                            options.check.string(), rows, options.limits.largest_row_error_px));
  }
}

void calibrate(const CalibrateOptions& options) {
  const BoardOrder order{request_of(options.source), pattern_of(options.board), options.boards,
                         options.limits, options.export_folder};
  if (!options.check.empty()) {
    check(options, order);
    return;
  }
  if (options.out.empty() && !options.source.source.starts_with("/dev/")) {
    throw Error("-o is needed: the calibration file to write, e.g. -o calibration.yml");
  }
  if (!options.out.empty()) {
    guard_output_file(options.out, inputs_of(options.source));
    require_ending(options.out, {".yml", ".yaml"}, "a calibration of OpenCV's YAML");
  }
  if (!options.export_folder.empty()) {
    guard_output_folder(options.export_folder, inputs_of(options.source));
  }
  ProgressBar bar;
  const CalibratedSource made = calibrate_source(order, options.out, linux_video(), shown_by(bar));
  bar.finish();
  if (options.json) {
    Json result = json_of(made.found, made.seen);
    result["file"] = made.file.string();
    print_json(result);
  } else {
    print_text("{}{}\n", text_of(made.found, made.seen, order.pattern), made.file.string());
  }
}

void add_result_options(Command command, CalibrateOptions& options) {
  command.begin_group("Result");
  command.add_option("-o,--out", options.out, "Calibration file to write (OpenCV YAML)")
      .default_is("for a camera, where palpable live finds it");
  command
      .add_option(
          "--export", options.export_folder,
          "Folder to which the calibration is written for other programs, too: left.yaml and "
          "right.yaml (ROS), intrinsics.yml and extrinsics.yml (OpenCV)")
      .type_name("DIR")
      .default_is("none");
  command
      .add_option("--check", options.check,
                  "Instead of calibrating: say by how many rows this calibration leaves the two "
                  "eyes' pictures of the board apart")
      .excludes("--out")
      .excludes("--export");
  command
      .add_option("--largest-reprojection", options.limits.largest_reprojection_px,
                  "Refuse a calibration whose reprojection error is larger, px rms")
      .positive()
      .show_default();
  command
      .add_option("--largest-row-error", options.limits.largest_row_error_px,
                  "Refuse one whose two eyes' rows are farther apart, px rms")
      .positive()
      .show_default();
  command.add_flag("--accept", options.limits.accept_weak,
                   "Write a calibration although it has fewer than 6 boards (3 at least), boards "
                   "tilted by less than 15 degrees, or a focal length with an uncertainty above "
                   "1 %, which is printed");
  command.add_json(options.json);
}

}  // namespace

void add_calibrate(Command app) {
  auto options = std::make_shared<CalibrateOptions>();
  Command command = app.add_subcommand(
      "calibrate",
      "Make a calibration file from pictures of a chessboard, or with a live stereo camera");
  add_source_argument(command, options->source,
                      "Stereo pairs of a board: a folder, images by name, a video file or a camera "
                      "(/dev/video0)");
  add_source_options(command, options->source, SourceOptionsFor::kCalibrate);
  add_board_options(command, options->board, SourceOptionsFor::kCalibrate);
  command.begin_group("Chessboard");
  command
      .add_option("--boards", options->boards,
                  "Pictures of the board to take with a camera; of a recording all count")
      .in_range(3, 1000)
      .show_default();
  add_result_options(command, *options);
  command.footer(
      "A flat board with an odd and an even number of inner corners, shown 15 times or more, near "
      "enough to fill the picture and tilted to all sides.\n"
      "Example: palpable calibrate boards --board 9x6 --square 25mm -o calibration.yml\n"
      "Example: palpable calibrate /dev/video0 --board 9x6 --square 25mm\n"
      "Example: palpable calibrate boards --square 25mm --check SN10027514.conf");
  command.callback([options] { calibrate(*options); });
}

}  // namespace palpable::app
