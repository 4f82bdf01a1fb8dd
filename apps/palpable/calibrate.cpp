// palpable calibrate: pictures of a chessboard to a calibration file, or a file's errors on them.

#include "apps/common/progress_bar.h"
#include "apps/palpable/board_options.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/source_options.h"
#include "palpable/base/error.h"
#include "palpable/vision/board_calibration.h"
#include "palpable/vision/open_source.h"
#include "palpable/vision/rectification.h"
#include "palpable/vision/source_calibration.h"
#include "palpable/vision/source_guard.h"

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

struct Options {
  SourceOptions source;
  BoardOptions board;
  int views = 20;
  double largest_reprojection_px = BoardLimits{}.largest_reprojection_px;
  double largest_row_error_px = BoardLimits{}.largest_row_error_px;
  fs::path check;
  fs::path output;
  bool json = false;
};

struct Seen {
  std::vector<BoardView> views;
  int pairs = 0;  // looked at
  int alike = 0;  // whose board was where another had been
};

// Looks at the source until it ends or, for a camera, until there are enough boards.
Seen look(FrameSource& source, const BoardPattern& pattern, int wanted) {
  // A board that has moved by less tells next to nothing new.
  const double new_px = 0.02 * source.format().width;
  Seen seen;
  SourceGuard guard(source);
  Frame frame;
  ProgressBar bar;
  const int total = source.is_live() ? wanted : source.frame_count();
  for (FrameStatus status = guard.next(frame); status != FrameStatus::kEnd;
       status = guard.next(frame)) {
    for (const std::string& line : guard.take_reports()) fmt::print(stderr, "{}\n", line);
    if (status != FrameStatus::kFrame) continue;
    ++seen.pairs;
    std::optional<BoardView> board = find_board(frame.left, frame.right, pattern);
    if (board) {
      board->number = frame.number;
      const bool alike = std::any_of(
          seen.views.begin(), seen.views.end(),
          [&](const BoardView& other) { return difference_px(*board, other) < new_px; });
      if (alike) {
        ++seen.alike;
      } else {
        seen.views.push_back(std::move(*board));
      }
    }
    const auto boards = static_cast<int>(seen.views.size());
    bar.show({source.is_live() ? "show the board, tilted to all sides" : "boards",
              static_cast<double>(source.is_live() ? boards : seen.pairs),
              static_cast<double>(std::max(total, seen.pairs)), fmt::format("{} boards", boards)});
    if (source.is_live() && boards == wanted) break;
  }
  bar.finish();
  return seen;
}

constexpr double kDegrees = 180 / std::numbers::pi;

nlohmann::ordered_json json_of(const BoardCalibration& found, const Seen& seen) {
  const StereoRig& rig = found.calibration.rig;
  nlohmann::ordered_json result;
  result["pairs"] = seen.pairs;
  result["boards"] = seen.views.size();
  for (const auto& [name, eye] : {std::pair{"left", &rig.left}, std::pair{"right", &rig.right}}) {
    result[name] = {{"fx_px", eye->pinhole.fx_px},
                    {"fy_px", eye->pinhole.fy_px},
                    {"cx_px", eye->pinhole.cx_px},
                    {"cy_px", eye->pinhole.cy_px},
                    {"distortion", eye->distortion}};
  }
  result["baseline_m"] = rig.right_from_left.translation().norm();
  result["reprojection_px"] = found.reprojection_px;
  result["row_error_px"] = found.row_error_px;
  result["focal_sigma"] = found.focal_sigma;
  result["tilt_degrees"] = found.tilt * kDegrees;
  result["covered"] = found.covered;
  return result;
}

void print(const BoardCalibration& found, const Seen& seen, const BoardPattern& pattern) {
  for (std::size_t i = 0; i < seen.views.size(); ++i) {
    fmt::print("pair {:>4}  reprojection {:.3f} px\n", seen.views[i].number,
               found.reprojections_px[i]);
  }
  fmt::print("{} boards in {} pairs", seen.views.size(), seen.pairs);
  if (seen.alike > 0) fmt::print(" ({} more were where another had been)", seen.alike);
  fmt::print("; tilt {:.0f} degrees, {:.0f} % of the picture covered\n", found.tilt * kDegrees,
             100 * found.covered);
  const StereoRig& rig = found.calibration.rig;
  for (const auto& [name, eye] : {std::pair{"left", &rig.left}, std::pair{"right", &rig.right}}) {
    const PinholeCamera& c = eye->pinhole;
    fmt::print("{:<6} f {:.2f} {:.2f} px, centre {:.2f} {:.2f} px, k1 {:.4f} k2 {:.4f}\n", name,
               c.fx_px, c.fy_px, c.cx_px, c.cy_px, eye->distortion[0], eye->distortion[1]);
  }
  const double baseline = rig.right_from_left.translation().norm();
  fmt::print("baseline {:.2f} mm ({:.3f} squares); focal length known to {:.2f} %\n",
             1e3 * baseline, baseline / pattern.square, 100 * found.focal_sigma);
  fmt::print("reprojection {:.3f} px rms, rows after rectification {:.3f} px rms\n",
             found.reprojection_px, found.row_error_px);
}

// Where the result goes: as asked, or for a camera where live will look for it.
fs::path output_of(const Options& options, const FrameFormat& format) {
  if (!options.output.empty()) return options.output;
  if (!options.source.source.starts_with("/dev/")) {
    throw Error("-o is needed: the calibration file to write, e.g. -o calibration.yml");
  }
  const CameraInfo info = value_or_throw(ask_camera(linux_video(), options.source.source));
  const fs::path folder = calibration_folders().front();
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw Error(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
  return folder / calibration_name(info.name, format.width, format.height);
}

// Before anybody shows boards. @throws Error when the file could not be written
void try_output(const fs::path& output) {
  std::error_code error;
  const bool was_there = fs::exists(output, error);
  const bool can_be = std::ofstream(output, std::ios::app).good();
  if (!was_there) fs::remove(output, error);
  if (!can_be) throw Error(fmt::format("{}: cannot be written", output.string()));
}

void check(const Options& options, const FrameFormat& format, const Seen& seen) {
  const SourceCalibration calibration =
      value_or_throw(read_source_calibration(options.check, format.width, format.height));
  const FrameFormat& checked = calibration.format;
  if (checked.kind != FrameFormat::Kind::kStereo || checked.already_rectified) {
    throw Error(fmt::format("{}: only the calibration of a raw stereo rig can be checked",
                            options.check.string()));
  }
  if (checked.width != format.width || checked.height != format.height) {
    throw Error(fmt::format("{}: is for images of {} x {} px but these are {} x {}",
                            options.check.string(), checked.width, checked.height, format.width,
                            format.height));
  }
  const Result<double> error = row_error_px(seen.views, checked.rig);
  if (!error.ok()) {
    throw Error(fmt::format("{}: {}; --board counts the inner corners", options.source.source,
                            error.problem().message));
  }
  const double rows = error.value();
  if (options.json) {
    const nlohmann::ordered_json result = {
        {"pairs", seen.pairs}, {"boards", seen.views.size()}, {"row_error_px", rows}};
    fmt::print("{}\n", result.dump(2));
  } else {
    fmt::print("{} boards in {} pairs: rows after rectification {:.3f} px rms\n", seen.views.size(),
               seen.pairs, rows);
  }
  if (rows > options.largest_row_error_px) {
    throw Error(fmt::format("{}: the rows are {:.2f} px apart; {:.2g} are allowed: calibrate again",
                            options.check.string(), rows, options.largest_row_error_px));
  }
}

void calibrate(const Options& options) {
  const BoardPattern pattern = pattern_of(options.board);
  CameraRequest request = request_of(options.source);
  request.without_calibration = true;
  request.calibration.clear();
  const std::unique_ptr<FrameSource> source = value_or_throw(open_source(request));
  const FrameFormat& format = source->format();
  if (format.kind != FrameFormat::Kind::kStereo) {
    throw Error(fmt::format("{}: holds colour and depth; stereo pairs are calibrated here",
                            options.source.source));
  }
  const fs::path output = options.check.empty() ? output_of(options, format) : fs::path();
  if (!output.empty()) try_output(output);
  const Seen seen = look(*source, pattern, options.views);
  if (!options.check.empty()) {
    check(options, format, seen);
    return;
  }
  BoardLimits limits;
  limits.largest_reprojection_px = options.largest_reprojection_px;
  limits.largest_row_error_px = options.largest_row_error_px;
  const Result<BoardCalibration> found =
      calibrate_boards(seen.views, pattern, format.width, format.height, limits);
  if (!found.ok()) {
    throw Error(
        fmt::format("{}: no calibration: {}", options.source.source, found.problem().message));
  }
  write_stereo_calibration(output, found.value().calibration);
  if (options.json) {
    nlohmann::ordered_json result = json_of(found.value(), seen);
    result["file"] = output.string();
    fmt::print("{}\n", result.dump(2));
    return;
  }
  print(found.value(), seen, pattern);
  fmt::print("{}\n", output.string());
}

}  // namespace

void add_calibrate(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "calibrate", "Pictures of a chessboard, or a live stereo camera, to a calibration file");
  command
      ->add_option("--source", options->source.source,
                   "Stereo pairs of a board: a folder, images by name, a video file or /dev/videoN")
      ->required();
  add_board_options(*command, options->board);
  command->add_option("--views", options->views, "Of a camera: boards to take")
      ->check(CLI::Range(6, 1000))
      ->capture_default_str();
  command
      ->add_option("--largest-reprojection", options->largest_reprojection_px,
                   "Refuse above this, px rms")
      ->capture_default_str();
  command
      ->add_option("--largest-row-error", options->largest_row_error_px,
                   "Refuse above this, px rms")
      ->capture_default_str();
  command->add_option("--check", options->check,
                      "Make none; say how far this calibration's rows are apart on the boards");
  command
      ->add_option("-o,--output", options->output,
                   "Calibration file (OpenCV YAML). Default for a camera: where palpable live "
                   "finds it")
      ->excludes("--check");
  command->add_flag("--json", options->json, "One JSON object on stdout, all else on stderr");
  add_source_options(*command, options->source);
  command->remove_option(command->get_option("--depth"));
  command->remove_option(command->get_option("--calibration"));
  command->footer(
      "A flat board with an odd and an even number of inner corners, shown 15 times or more, near\n"
      "enough to fill the picture and tilted to all sides.\n"
      "Example: palpable calibrate --source boards --board 9x6 --square 25 -o calibration.yml\n"
      "Example: palpable calibrate --source /dev/video0 --board 9x6 --square 25\n"
      "Example: palpable calibrate --source boards --square 25 --check SN10027514.conf");
  command->callback([options] { calibrate(*options); });
}

}  // namespace palpable::app
