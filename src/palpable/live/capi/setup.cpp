#include "palpable/live/capi/setup.h"

#include "palpable/common/base/error.h"
#include "palpable/live/capi/guarded.h"
#include "palpable/live/depth/depth_settings.h"
#include "palpable/live/sources/source_calibration.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

namespace palpable {
namespace {

constexpr int kMostThreadsAsked = 64;
constexpr int kLeastSide = 16, kMostSide = 16384;  // px

[[noreturn]] void refuse(const std::string& why) { throw Failure(PALPABLE_WRONG_ARGUMENT, why); }

// A setting that must be 0 or 1.
bool is_on(int value, const char* name) {
  if (value != 0 && value != 1) refuse(fmt::format("setup.{} is {}, neither 0 nor 1", name, value));
  return value == 1;
}

bool is_stereo(const palpable_setup& setup) { return setup.camera == PALPABLE_STEREO; }

// Whether a number of the setup repeats that of a file: to 1 %, since somebody writes two digits.
bool repeats(double given, double of_file) {
  return std::abs(given - of_file) <= 0.01 * std::abs(of_file);
}

// An unlikely baseline of the file is meant if setup has it, too.
BaselineRule baseline_rule(const palpable_setup& setup, const FrameFormat& format) {
  const std::optional<double> baseline = baseline_of(format);
  return baseline && repeats(setup.baseline, *baseline) ? BaselineRule::kAnyPossible
                                                        : BaselineRule::kUsual;
}

// Numbers beside a calibration file may repeat it, but not say something else.
void expect_no_contradiction(const palpable_setup& setup, const FrameFormat& format) {
  const auto expect = [&](const char* name, double given, double of_file) {
    if (given == 0 || repeats(given, of_file)) return;
    refuse(fmt::format("setup.{} is {}, and {} has {}: leave one of them out", name, given,
                       setup.calibration, of_file));
  };
  if (const std::optional<double> baseline = baseline_of(format)) {
    expect("baseline", setup.baseline, *baseline);
  }
  // Raw pairs have two lenses, which no setup describes.
  if (is_stereo(setup) && !format.already_rectified) return;
  const PinholeCamera& camera = is_stereo(setup) ? format.rectified.camera : format.depth_camera;
  expect("fx", setup.fx, camera.fx_px);
  expect("fy", setup.fy, camera.fy_px);
  expect("cx", setup.cx, camera.cx_px);
  expect("cy", setup.cy, camera.cy_px);
}

FrameFormat format_of_file(const palpable_setup& setup) {
  const auto read = read_source_calibration(
      setup.calibration, setup.width, setup.height,
      is_stereo(setup) ? FrameFormat::Kind::kStereo : FrameFormat::Kind::kColorDepth);
  if (!read.ok()) throw Failure(PALPABLE_WRONG_FILE, read.problem().message);
  SourceCalibration calibration = read.value();
  FrameFormat format = calibration.format;
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
  if (format.width <= 0 || format.height <= 0) return format;  // camera_setup() refuses it
  calibration.format = format;
  if (const auto problem = problem_with(calibration, baseline_rule(setup, format),
                                        "if it is meant, set setup.baseline to it, too")) {
    throw Failure(PALPABLE_WRONG_FILE, problem->message);
  }
  if (setup.width != 0 || setup.height != 0) {
    if (setup.width != format.width || setup.height != format.height) {
      refuse(fmt::format("{} is of images of {} x {} px, and setup has {} x {}", setup.calibration,
                         format.width, format.height, setup.width, setup.height));
    }
  }
  expect_no_contradiction(setup, format);
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
  if (setup.threads < 0 || setup.threads > kMostThreadsAsked) {
    refuse(
        fmt::format("setup.threads is {}, not within 0 and {}", setup.threads, kMostThreadsAsked));
  }
  // The matcher has no use for more threads; how many there are changes no result.
  if (setup.threads != 0) depth.threads = std::min<int>(setup.threads, kMostThreads);
  depth.full_resolution = is_on(setup.full_resolution, "full_resolution");
  const double farthest = depth.farthest.value_or(kUsualFarthest);
  if (!(depth.nearest >= 0.01 && depth.nearest < farthest && farthest <= 1000)) {
    refuse(fmt::format("setup: depths from {} to {} m; 0.01 to 1000 are possible", depth.nearest,
                       farthest));
  }
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

}  // namespace palpable
