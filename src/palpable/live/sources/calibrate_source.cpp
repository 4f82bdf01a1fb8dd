#include "palpable/live/sources/calibrate_source.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/live/calibrate/calibration_check.h"
#include "palpable/live/calibrate/calibration_file.h"
#include "palpable/live/calibrate/exported_calibration.h"
#include "palpable/live/sources/open_source.h"
#include "palpable/live/sources/source_calibration.h"

#include <fmt/core.h>

#include <memory>
#include <string>
#include <utility>

namespace palpable {
namespace {

namespace fs = std::filesystem;

std::unique_ptr<FrameSource> open_raw_pairs(CameraRequest request, VideoSystem& system) {
  request.without_calibration = true;
  request.calibration.clear();
  std::unique_ptr<FrameSource> source = value_or_throw(open_source(request, system));
  if (source->format().kind != FrameFormat::Kind::kStereo) {
    throw Error(fmt::format("{}: holds colour and depth; stereo pairs are calibrated here",
                            request.device));
  }
  return source;
}

// The file in which `palpable live` will look for this camera's calibration.
fs::path kept_file(const CameraRequest& request, const FrameFormat& format, VideoSystem& system) {
  if (!request.device.starts_with("/dev/")) {
    throw Error(fmt::format(
        "{}: only a camera's calibration has a place of its own; name the file to write",
        request.device));
  }
  const CameraInfo info = value_or_throw(query_camera(system, request.device));
  const fs::path folder = request.folders.front();
  make_folder(folder);
  return folder / calibration_name(info.name, format.width, format.height);
}

StereoRig rig_to_check(const fs::path& file, const FrameFormat& format, BaselineRule baselines) {
  const SourceCalibration read =
      value_or_throw(read_source_calibration(file, format.width, format.height));
  if (const auto problem = problem_with(read, baselines)) throw Error(problem->message);
  const FrameFormat& checked = read.format;
  if (checked.kind != FrameFormat::Kind::kStereo || checked.already_rectified) {
    throw Error(
        fmt::format("{}: only the calibration of a raw stereo rig can be checked", file.string()));
  }
  if (checked.width != format.width || checked.height != format.height) {
    throw Error(fmt::format("{}: is for images of {} x {} px but these are {} x {}", file.string(),
                            checked.width, checked.height, format.width, format.height));
  }
  return checked.rig;
}

}  // namespace

CalibratedSource calibrate_source(const BoardOrder& order, const fs::path& file,
                                  VideoSystem& system,
                                  const std::function<void(const BoardSearchStep&)>& on_step) {
  const std::unique_ptr<FrameSource> source = open_raw_pairs(order.source, system);
  const FrameFormat& format = source->format();
  CalibratedSource result;
  result.file = file.empty() ? kept_file(order.source, format, system) : file;
  expect_writable(result.file);  // fails before anybody shows boards
  if (!order.export_folder.empty()) {
    make_folder(order.export_folder);
    for (const char* name : kExportedFiles) expect_writable(order.export_folder / name);
  }
  result.seen = find_boards(*source, order.pattern, order.views, on_step);
  Result<BoardCalibration> found =
      calibrate_boards(result.seen.views, order.pattern, format.width, format.height, order.limits);
  if (!found.ok()) {
    throw Error(
        fmt::format("{}: no calibration: {}", order.source.device, found.problem().message));
  }
  result.found = std::move(found.value());
  const StereoRig& rig = result.found.calibration.rig;
  const std::string unlikely =
      what_is_unlikely_about_baseline(rig.right_from_left.translation().norm());
  if (order.source.baselines == BaselineRule::kUsual && !unlikely.empty()) {
    throw Error(fmt::format(
        "{}: no calibration: {}; --square {:g}mm was given: is that the side of a square? "
        "--baseline-ok takes it as it is",
        order.source.device, unlikely, 1e3 * order.pattern.square));
  }
  write_stereo_calibration(result.file, result.found.calibration);
  if (!order.export_folder.empty()) export_calibration(order.export_folder, rig);
  return result;
}

CheckedCalibration check_calibration(const BoardOrder& order, const fs::path& file,
                                     VideoSystem& system,
                                     const std::function<void(const BoardSearchStep&)>& on_step) {
  const std::unique_ptr<FrameSource> source = open_raw_pairs(order.source, system);
  const StereoRig rig = rig_to_check(file, source->format(),
                                     order.source.baselines);  // fails before anybody shows boards
  CheckedCalibration result;
  result.seen = find_boards(*source, order.pattern, order.views, on_step);
  const Result<double> error = row_error_px(result.seen.views, rig);
  if (!error.ok()) {
    throw Error(fmt::format("{}: {}; one of {}x{} inner corners was looked for",
                            order.source.device, error.problem().message, order.pattern.columns,
                            order.pattern.rows));
  }
  result.row_error_px = error.value();
  result.baseline = rig.right_from_left.translation().norm();
  return result;
}

}  // namespace palpable
