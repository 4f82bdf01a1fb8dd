#include "palpable/live/capi/setup.h"

#include "palpable/common/base/error.h"
#include "palpable/live/capi/guarded.h"
#include "palpable/live/depth/depth_settings.h"
#include "palpable/live/sources/source_calibration.h"

#include <Eigen/Geometry>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace palpable {
namespace {

constexpr int kLeastSide = 16, kMostSide = 16384;  // px
constexpr double kFarthest = 1e4;                  // m, largest coordinate of a pose's translation

using RowMajor = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

[[noreturn]] void refuse(const std::string& why) { throw Failure(PALPABLE_WRONG_ARGUMENT, why); }

// A setting that must be 0 or 1.
bool is_on(int value, const char* name) {
  if (value != 0 && value != 1) refuse(fmt::format("setup.{} is {}, neither 0 nor 1", name, value));
  return value == 1;
}

bool is_stereo(const palpable_setup& setup) { return setup.camera == PALPABLE_STEREO; }

FrameFormat format_of_file(const palpable_setup& setup) {
  const auto read = read_source_calibration(setup.calibration, setup.width, setup.height);
  if (!read.ok()) throw Failure(PALPABLE_WRONG_FILE, read.problem().message);
  FrameFormat format = read.value().format;
  if ((format.kind == FrameFormat::Kind::kStereo) != is_stereo(setup)) {
    throw Failure(PALPABLE_WRONG_FILE,
                  fmt::format("{} is of the other kind of camera: {}", setup.calibration,
                              is_stereo(setup) ? "depth" : "a stereo pair"));
  }
  if (format.color_sensor) {
    throw Failure(PALPABLE_NOT_POSSIBLE,
                  fmt::format("{} has a colour camera beside the depth's; images of one view are "
                              "wanted here",
                              setup.calibration));
  }
  const bool knows_size = format.width > 0 && format.height > 0;
  if (!knows_size) set_size(format, setup.width, setup.height);
  if (setup.width != 0 || setup.height != 0) {
    if (setup.width != format.width || setup.height != format.height) {
      refuse(fmt::format("{} is of images of {} x {} px, and setup has {} x {}", setup.calibration,
                         format.width, format.height, setup.width, setup.height));
    }
  }
  return format;
}

FrameFormat format_of_numbers(const palpable_setup& setup) {
  const PinholeCamera camera{setup.width, setup.height, setup.fx, setup.fy, setup.cx, setup.cy};
  FrameFormat format;
  format.width = setup.width;
  format.height = setup.height;
  if (is_stereo(setup)) {
    format.already_rectified = true;
    format.rectified = {camera, setup.baseline};
  } else {
    format.kind = FrameFormat::Kind::kColorDepth;
    format.depth_camera = camera;
  }
  return format;
}

DepthSettings depth_settings(const palpable_setup& setup) {
  DepthSettings depth;
  if (setup.nearest != 0) depth.nearest = setup.nearest;
  if (setup.farthest != 0) depth.farthest = setup.farthest;
  if (setup.threads != 0) depth.threads = setup.threads;
  depth.full_resolution = is_on(setup.full_resolution, "full_resolution");
  const double farthest = depth.farthest.value_or(kUsualFarthest);
  if (!(depth.nearest >= 0.01 && depth.nearest < farthest && farthest <= 1000)) {
    refuse(fmt::format("setup: depths from {} to {} m; 0.01 to 1000 are possible", depth.nearest,
                       farthest));
  }
  if (depth.threads < 1) refuse(fmt::format("setup.threads is {}", depth.threads));
  return depth;
}

}  // namespace

CameraSetup camera_setup(const palpable_setup& setup) {
  if (!is_stereo(setup) && setup.camera != PALPABLE_COLOR_DEPTH) {
    refuse(fmt::format("setup.camera is {}, which is none", setup.camera));
  }
  CameraSetup made;
  made.format = setup.calibration != nullptr ? format_of_file(setup) : format_of_numbers(setup);
  const auto [width, height] = std::pair(made.format.width, made.format.height);
  if (std::min(width, height) < kLeastSide || std::max(width, height) > kMostSide) {
    refuse(fmt::format("images of {} x {} px; sides of {} to {} are possible", width, height,
                       kLeastSide, kMostSide));
  }
  made.session.track = is_on(setup.follow_camera, "follow_camera");
  made.session.press_static = is_on(setup.press_static, "press_static");
  // The map tells what is new from what was always there. With press_static and a camera that
  // stands still everything presses, so that no map is needed.
  made.session.map = made.session.track || !made.session.press_static;
  made.session.depth = depth_settings(setup);
  return made;
}

Rigid3 pose_of(const double* rows, const char* name) {
  const auto wrong = [&](const char* what) { refuse(fmt::format("{}: {}", name, what)); };
  if (rows == nullptr) wrong("is null");
  const RowMajor m = Eigen::Map<const RowMajor>(rows);
  if (!m.allFinite()) wrong("holds what is no number");
  if (m.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) wrong("its last row is not 0 0 0 1");
  if (m.topRightCorner<3, 1>().cwiseAbs().maxCoeff() > kFarthest) wrong("is farther than 10 km");
  const Eigen::Matrix3d R = m.topLeftCorner<3, 3>();
  const double off = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(off <= 1e-3) || R.determinant() < 0) wrong("holds no rotation");
  Rigid3 pose = Rigid3::Identity();
  pose.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
  pose.translation() = m.topRightCorner<3, 1>();
  return pose;
}

void write_pose(const Rigid3& pose, double rows[16]) { Eigen::Map<RowMajor>{rows} = pose.matrix(); }

}  // namespace palpable
