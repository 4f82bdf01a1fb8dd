#include "palpable/live/sources/foreign_calibration.h"

#include "palpable/live/calibrate/kalibr_camchain.h"
#include "palpable/live/calibrate/opencv_stereo_files.h"
#include "palpable/live/calibrate/realsense_file.h"
#include "palpable/live/calibrate/rectification.h"
#include "palpable/live/calibrate/ros_camera_info.h"
#include "palpable/live/sources/calibration_partner.h"

#include <fmt/core.h>

namespace palpable {
namespace {

Problem about(const std::string& file, const Problem& problem) {
  return Problem{fmt::format("calibration {} {}", file, problem.message)};
}

std::string name_of(const CalibrationPair& pair) {
  return fmt::format("{} and {}", pair.first.path.string(), pair.second.path.string());
}

Result<SourceCalibration> from_foreign_rig(const Result<StereoRig>& rig, const std::string& file) {
  if (!rig.ok()) return about(file, rig.problem());
  StereoCalibration stereo;
  stereo.rig = rig.value();
  stereo.rate_is_stated = false;
  return from_rig(stereo, file);
}

Result<SourceCalibration> from_stereo(const Result<RectifiedStereo>& stereo,
                                      const std::string& file) {
  if (!stereo.ok()) return about(file, stereo.problem());
  return from_rectified({stereo.value(), 30, false}, file);
}

Result<SourceCalibration> from_depth_camera(const Result<DistortedCamera>& lens,
                                            const std::string& file) {
  if (!lens.ok()) return about(file, lens.problem());
  SourceCalibration calibration;
  calibration.file = file;
  FrameFormat& format = calibration.format;
  format.kind = FrameFormat::Kind::kColorDepth;
  format.depth_camera = lens.value().pinhole;
  set_size(format, format.depth_camera.width, format.depth_camera.height);
  if (auto problem = problem_with(calibration, BaselineRule::kUsual)) return *problem;
  constexpr double kMuch = 0.5;  // px
  const double off = largest_distortion_px(lens.value());
  if (off > kMuch) {
    calibration.guesses.push_back(fmt::format(
        "{}: its lens distortion, {:.1f} px in a corner, is not undone: pictures of colour and "
        "depth are taken for rectified ones",
        file, off));
  }
  return calibration;
}

Result<SourceCalibration> of_opencv(const CalibrationText& lenses, const CalibrationText& pose,
                                    const std::string& file, int width, int height) {
  Result<SourceCalibration> calibration =
      from_foreign_rig(rig_of_opencv(lenses.keys, pose.keys, width, height), file);
  const bool is_stated = states_opencv_size(lenses.keys) || states_opencv_size(pose.keys);
  if (calibration.ok() && !is_stated && width > 0) {
    calibration.value().guesses.push_back(
        fmt::format("no picture size is stated in {}: it is taken to be for these, {} x {}", file,
                    width, height));
  }
  return calibration;
}

Result<SourceCalibration> of_ros(const CalibrationText& half,
                                 std::optional<FrameFormat::Kind> kind) {
  if (kind == FrameFormat::Kind::kColorDepth) {
    const Result<RosCamera> camera = read_ros_camera(half.keys);
    if (!camera.ok()) return about(half.path.string(), camera.problem());
    return from_depth_camera(camera.value().lens, half.path.string());
  }
  // A fault of the file that was named comes before that of a missing other one.
  const Result<RosCamera> named = read_ros_camera(half.keys);
  if (!named.ok()) return about(half.path.string(), named.problem());
  const Result<CalibrationPair> pair = pair_of(half);
  if (!pair.ok()) return pair.problem();
  const Result<RosCamera> left = read_ros_camera(pair.value().first.keys);
  if (!left.ok()) return about(pair.value().first.path.string(), left.problem());
  const Result<RosCamera> right = read_ros_camera(pair.value().second.keys);
  if (!right.ok()) return about(pair.value().second.path.string(), right.problem());
  const std::string file = name_of(pair.value());
  if (const auto stereo = rectified_of_ros(left.value(), right.value())) {
    return from_stereo(*stereo, file);
  }
  return from_foreign_rig(rig_of_ros(left.value(), right.value()), file);
}

Result<SourceCalibration> of_realsense(const CalibrationText& file, int width, int height,
                                       std::optional<FrameFormat::Kind> kind) {
  const bool is_json = file.kind == CalibrationKind::kRealsenseJson;
  const std::string name = file.path.string();
  const bool of_depth = kind == FrameFormat::Kind::kColorDepth;
  Result<SourceCalibration> calibration =
      of_depth ? from_depth_camera(is_json ? depth_of_realsense(file.keys, width, height)
                                           : depth_of_realsense(file.text, width, height),
                                   name)
               : from_stereo(is_json ? stereo_of_realsense(file.keys, width, height)
                                     : stereo_of_realsense(file.text, width, height),
                             name);
  if (!calibration.ok()) return calibration;
  calibration.value().has_more_sizes = true;
  if (of_depth) {
    calibration.value().guesses.push_back(fmt::format(
        "{}: the pictures are taken to be of the depth's view (infrared); of the colour camera's "
        "write intrinsics.txt, its numbers for depth that was aligned to colour, else with a line "
        "`color`",
        name));
  }
  return calibration;
}

}  // namespace

Result<SourceCalibration> from_rig(const StereoCalibration& stereo, const std::string& file) {
  SourceCalibration calibration;
  calibration.file = file;
  calibration.format.rig = stereo.rig;
  calibration.format.width = stereo.rig.left.pinhole.width;
  calibration.format.height = stereo.rig.left.pinhole.height;
  calibration.frames_per_second = stereo.frames_per_second;
  calibration.rate_is_stated = stereo.rate_is_stated;
  if (calibration.format.width == 0) return calibration;
  const Result<RectifiedGeometry> geometry = rectify_rig(stereo.rig);
  if (!geometry.ok()) {
    return Problem{
        fmt::format("calibration {} cannot be used: {}", file, geometry.problem().message)};
  }
  return calibration;
}

SourceCalibration from_rectified(const RectifiedCalibration& rectified, const std::string& file) {
  SourceCalibration calibration;
  calibration.file = file;
  calibration.format.already_rectified = true;
  calibration.format.rectified = rectified.stereo;
  calibration.format.width = rectified.stereo.camera.width;
  calibration.format.height = rectified.stereo.camera.height;
  calibration.frames_per_second = rectified.frames_per_second;
  calibration.rate_is_stated = rectified.rate_is_stated;
  return calibration;
}

Result<SourceCalibration> read_foreign_calibration(const CalibrationText& file, int width,
                                                   int height,
                                                   std::optional<FrameFormat::Kind> kind) {
  const std::string name = file.path.string();
  switch (file.kind) {
    case CalibrationKind::kOpencvRig:
      return of_opencv(file, file, name, width, height);
    case CalibrationKind::kOpencvLenses:
    case CalibrationKind::kOpencvPose: {
      const Result<CalibrationPair> pair = pair_of(file);
      if (!pair.ok()) return pair.problem();
      return of_opencv(pair.value().first, pair.value().second, name_of(pair.value()), width,
                       height);
    }
    case CalibrationKind::kRosCamera:
      return of_ros(file, kind);
    case CalibrationKind::kCamchain:
      if (kind == FrameFormat::Kind::kColorDepth) {
        return from_depth_camera(camera_of_camchain(file.keys), name);
      }
      return from_foreign_rig(rig_of_camchain(file.keys), name);
    case CalibrationKind::kRealsenseJson:
    case CalibrationKind::kRealsenseListing:
      return of_realsense(file, width, height, kind);
    case CalibrationKind::kCameraJson:
      return from_depth_camera(camera_of_json(file.keys), name);
    default:
      return Problem{fmt::format("calibration {} {}", name, file.not_read)};
  }
}

}  // namespace palpable
