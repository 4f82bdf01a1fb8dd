#include "palpable/live/depth/depth_sensor_camera.h"

#include "palpable/live/calibrate/rectification.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpable {
namespace {

std::optional<Problem> problem_of(const PinholeCamera& camera, const char* which) {
  if (camera.fx_px > 0 && camera.fy_px > 0 &&
      std::isfinite(camera.fx_px + camera.fy_px + camera.cx_px + camera.cy_px)) {
    return std::nullopt;
  }
  return Problem{
      fmt::format("the {} camera's focal lengths are {} and {} px; they should be "
                  "positive",
                  which, camera.fx_px, camera.fy_px)};
}

std::optional<Problem> problem_of(const ColorSensor& color, const FrameFormat& format) {
  if (auto problem = problem_of(color.camera, "colour")) return problem;
  if (color.camera.width != format.width || color.camera.height != format.height) {
    return Problem{fmt::format("the images are {} x {} but the colour camera is {} x {}",
                               format.width, format.height, color.camera.width,
                               color.camera.height)};
  }
  if (!color.color_from_depth.matrix().allFinite()) {
    return Problem{"how the colour camera stands to the depth camera is not finite"};
  }
  return std::nullopt;
}

}  // namespace

Result<DepthSensorCamera> DepthSensorCamera::make(const FrameFormat& format,
                                                  const DepthSettings& settings) {
  if (auto problem = problem_of(format.depth_camera, "depth")) return *problem;
  DepthSensorCamera made;
  made.width_ = format.width;
  made.height_ = format.height;
  made.farthest_ = settings.farthest.value_or(kUsualFarthest);
  made.camera_ = format.depth_camera;
  if (format.color_sensor) {
    const ColorSensor& color = *format.color_sensor;
    if (auto problem = problem_of(color, format)) return *problem;
    made.camera_ = color.camera;
    made.registration_.emplace(format.depth_camera, color);
  }
  return made;
}

bool DepthSensorCamera::measure(const Frame& frame, SeenFrame& seen, StageTimes& times) {
  if (frame.left.width() != width_ || frame.left.height() != height_ ||
      frame.depth.width() != width_ || frame.depth.height() != height_) {
    return false;
  }
  const StageTimer timer(times, "depth");
  std::copy(frame.left.begin(), frame.left.end(), seen.color.begin());
  Rectification::luma(seen.color, seen.left);
  DepthImage& known = registration_ ? own_view_ : seen.depth;
  known.resize(width_, height_);
  std::transform(frame.depth.begin(), frame.depth.end(), known.begin(), [&](float Z) {
    // False for NaN, so that unknown depths stay unknown.
    return Z > 0 && Z <= farthest_ ? Z : std::numeric_limits<float>::quiet_NaN();
  });
  if (registration_) registration_->to_color(own_view_, seen.depth);
  return true;
}

}  // namespace palpable
