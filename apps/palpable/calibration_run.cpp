#include "apps/palpable/calibration_run.h"

#include "apps/common/json.h"
#include "apps/common/progress_bar.h"
#include "palpable/base/error.h"
#include "palpable/base/output_file.h"
#include "palpable/calibrate/rectification.h"
#include "palpable/sources/open_source.h"
#include "palpable/sources/seen_boards.h"
#include "palpable/sources/source_calibration.h"

#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

// With a bar, and the source's troubles on stderr.
SeenBoards search(FrameSource& source, const BoardPattern& pattern, int wanted) {
  ProgressBar bar;
  const bool live = source.is_live();
  const int total = source.frame_count();
  SeenBoards seen = find_boards(source, pattern, wanted, [&](const BoardSearchStep& step) {
    for (const std::string& line : step.reports) fmt::print(stderr, "{}\n", line);
    if (!step.searched) return;
    const auto boards = static_cast<int>(step.seen.views.size());
    bar.show({live ? "show the board, tilted to all sides" : "boards",
              static_cast<double>(live ? boards : step.seen.pairs),
              static_cast<double>(live ? wanted : std::max(total, step.seen.pairs)),
              fmt::format("{} boards", boards)});
  });
  bar.finish();
  return seen;
}

constexpr double kDegrees = 180 / std::numbers::pi;

Json json_of(const BoardCalibration& found, const SeenBoards& seen) {
  const StereoRig& rig = found.calibration.rig;
  Json result;
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

std::string text_of(const BoardCalibration& found, const SeenBoards& seen,
                    const BoardPattern& pattern) {
  std::string text;
  for (std::size_t i = 0; i < seen.views.size(); ++i) {
    text += fmt::format("pair {:>4}  reprojection {:.3f} px\n", seen.views[i].number,
                        found.reprojections_px[i]);
  }
  text += fmt::format("{} boards in {} pairs", seen.views.size(), seen.pairs);
  if (seen.alike > 0) text += fmt::format(" ({} more were where another had been)", seen.alike);
  text += fmt::format("; tilt {:.0f} degrees, {:.0f} % of the picture covered\n",
                      found.tilt * kDegrees, 100 * found.covered);
  const StereoRig& rig = found.calibration.rig;
  for (const auto& [name, eye] : {std::pair{"left", &rig.left}, std::pair{"right", &rig.right}}) {
    const PinholeCamera& c = eye->pinhole;
    text += fmt::format("{:<6} f {:.2f} {:.2f} px, centre {:.2f} {:.2f} px, k1 {:.4f} k2 {:.4f}\n",
                        name, c.fx_px, c.fy_px, c.cx_px, c.cy_px, eye->distortion[0],
                        eye->distortion[1]);
  }
  const double baseline = rig.right_from_left.translation().norm();
  text += fmt::format("baseline {:.2f} mm ({:.3f} squares); focal length known to {:.2f} %\n",
                      1e3 * baseline, baseline / pattern.square, 100 * found.focal_sigma);
  text += fmt::format("reprojection {:.3f} px rms, rows after rectification {:.3f} px rms\n",
                      found.reprojection_px, found.row_error_px);
  return text;
}

// Where the result goes: as asked, or for a camera where live will look for it.
fs::path output_of(const CalibrationTask& task, const FrameFormat& format, VideoSystem& system) {
  if (!task.output.empty()) return task.output;
  const std::string& device = task.source.device;
  if (!device.starts_with("/dev/")) {
    throw Error("-o is needed: the calibration file to write, e.g. -o calibration.yml");
  }
  const CameraInfo info = value_or_throw(ask_camera(system, device));
  const fs::path folder = task.source.folders.front();
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw Error(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
  return folder / calibration_name(info.name, format.width, format.height);
}

CalibrationReport check(const CalibrationTask& task, const FrameFormat& format,
                        const SeenBoards& seen) {
  const SourceCalibration calibration =
      value_or_throw(read_source_calibration(task.check, format.width, format.height));
  const FrameFormat& checked = calibration.format;
  if (checked.kind != FrameFormat::Kind::kStereo || checked.already_rectified) {
    throw Error(fmt::format("{}: only the calibration of a raw stereo rig can be checked",
                            task.check.string()));
  }
  if (checked.width != format.width || checked.height != format.height) {
    throw Error(fmt::format("{}: is for images of {} x {} px but these are {} x {}",
                            task.check.string(), checked.width, checked.height, format.width,
                            format.height));
  }
  const Result<double> error = row_error_px(seen.views, checked.rig);
  if (!error.ok()) {
    throw Error(fmt::format("{}: {}; --board counts the inner corners", task.source.device,
                            error.problem().message));
  }
  const double rows = error.value();
  const Json json = {{"pairs", seen.pairs}, {"boards", seen.views.size()}, {"row_error_px", rows}};
  CalibrationReport report;
  report.text = task.json
                    ? json.dump(2) + "\n"
                    : fmt::format("{} boards in {} pairs: rows after rectification {:.3f} px rms\n",
                                  seen.views.size(), seen.pairs, rows);
  if (rows > task.limits.largest_row_error_px) {
    report.refused =
        fmt::format("{}: the rows are {:.2f} px apart; {:.2g} are allowed: calibrate again",
                    task.check.string(), rows, task.limits.largest_row_error_px);
  }
  return report;
}

}  // namespace

CalibrationReport calibrate(const CalibrationTask& task, VideoSystem& system) {
  CameraRequest request = task.source;
  request.without_calibration = true;
  request.calibration.clear();
  const std::unique_ptr<FrameSource> source = value_or_throw(open_source(request, system));
  const FrameFormat& format = source->format();
  if (format.kind != FrameFormat::Kind::kStereo) {
    throw Error(fmt::format("{}: holds colour and depth; stereo pairs are calibrated here",
                            request.device));
  }
  const fs::path output = task.check.empty() ? output_of(task, format, system) : fs::path();
  if (!output.empty()) expect_writable(output);  // before anybody shows boards
  const SeenBoards seen = search(*source, task.pattern, task.views);
  if (!task.check.empty()) return check(task, format, seen);
  const Result<BoardCalibration> found =
      calibrate_boards(seen.views, task.pattern, format.width, format.height, task.limits);
  if (!found.ok()) {
    throw Error(fmt::format("{}: no calibration: {}", request.device, found.problem().message));
  }
  write_stereo_calibration(output, found.value().calibration);
  CalibrationReport report;
  if (task.json) {
    Json result = json_of(found.value(), seen);
    result["file"] = output.string();
    report.text = result.dump(2) + "\n";
  } else {
    report.text = text_of(found.value(), seen, task.pattern) + output.string() + "\n";
  }
  return report;
}

}  // namespace palpable::app
