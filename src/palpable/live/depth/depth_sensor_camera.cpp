#include "palpable/live/depth/depth_sensor_camera.h"

#include "palpable/live/calibrate/calibration_check.h"
#include "palpable/live/calibrate/rectification.h"
#include "palpable/live/depth/flying_pixels.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <tuple>

namespace palpable {

Result<DepthSensorCamera> DepthSensorCamera::make(const FrameFormat& format,
                                                  const DepthSettings& settings) {
  const std::string wrong = what_is_wrong_with(format);
  if (!wrong.empty()) return Problem{wrong};
  DepthSensorCamera made;
  made.width_ = format.width;
  made.height_ = format.height;
  std::tie(made.depth_width_, made.depth_height_) = depth_size_of(format);
  const bool same_size = made.depth_width_ == format.width && made.depth_height_ == format.height;
  if (!format.color_sensor && !same_size) {
    return Problem{
        fmt::format("the depth is {} x {} px and the colour {} x {}: the colour camera "
                    "should be described, too",
                    made.depth_width_, made.depth_height_, format.width, format.height)};
  }
  made.farthest_ = settings.farthest.value_or(kUsualFarthest);
  made.depth_unit_ = format.depth_unit;
  made.focal_px_ = static_cast<float>(format.depth_camera.fx_px);
  made.camera_ = format.depth_camera;
  if (format.color_sensor) {
    const ColorSensor& color = *format.color_sensor;
    made.camera_ = color.camera;
    made.registration_.emplace(format.depth_camera, color);
  }
  return made;
}

bool DepthSensorCamera::measure(const Frame& frame, SeenFrame& seen, StageTimes& times) {
  if (frame.left.width() != width_ || frame.left.height() != height_ ||
      frame.depth.width() != depth_width_ || frame.depth.height() != depth_height_) {
    return false;
  }
  const StageTimer timer(times, "depth");
  std::copy(frame.left.begin(), frame.left.end(), seen.color.begin());
  Rectification::luma(seen.color, seen.left);
  DepthImage& known = registration_ ? own_view_ : seen.depth;
  leave_out_flying_pixels(frame.depth, focal_px_, static_cast<float>(farthest_), known);
  if (registration_) registration_->to_color(own_view_, seen.depth);
  survey(frame.depth, seen.measured);
  return true;
}

void DepthSensorCamera::survey(const DepthImage& depth, MeasuredDepth& measured) const {
  std::size_t found = 0, too_far = 0;
  for (const float Z : depth) {
    found += Z > 0;
    too_far += Z > farthest_;
  }
  const auto pixels = static_cast<double>(std::max<std::size_t>(depth.size(), 1));
  measured.measured = static_cast<double>(found) / pixels;
  measured.too_far = static_cast<double>(too_far) / pixels;
  constexpr float kMostSteps = 65534;
  const auto per_metre = static_cast<float>(depth_unit_ > 0 ? 1 / depth_unit_ : 0);
  for (int y = 0; y < depth.height(); y += sample_step(depth.height())) {
    int before = 0;
    for (int x = 0; x < depth.width(); ++x) {
      const float Z = depth(x, y);
      measured.sample(Z);
      const float steps = Z * per_metre + 0.5F;
      const int number = steps >= 1 && steps <= kMostSteps + 1 ? static_cast<int>(steps) : 0;
      if (number > 0) measured.steps.add(number, before);
      before = number;
    }
  }
}

}  // namespace palpable
