#include "palpable/live/depth/stereo_eyes.h"

#include "palpable/live/calibrate/calibration_check.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace palpable {
namespace {

Result<Rectification> rectification_of(const FrameFormat& format) {
  if (format.already_rectified) {
    const std::string wrong = what_is_wrong_with(format.rectified);
    if (!wrong.empty()) return Problem{wrong};
    return Rectification(format.rectified);
  }
  const Result<RectifiedGeometry> geometry = rectify_rig(format.rig);
  if (!geometry.ok()) return geometry.problem();
  return Rectification(format.rig);
}

}  // namespace

Result<StereoEyes> StereoEyes::make(const FrameFormat& format, const DepthSettings& settings) {
  const PinholeCamera& given =
      format.already_rectified ? format.rectified.camera : format.rig.left.pinhole;
  if (given.width != format.width || given.height != format.height) {
    return Problem{fmt::format("the images are {} x {} but the calibration is for {} x {}",
                               format.width, format.height, given.width, given.height)};
  }
  Result<Rectification> rectification = rectification_of(format);
  if (!rectification.ok()) return rectification.problem();
  StereoEyes eyes(std::move(rectification).value(), format, settings);
  if (eyes.matched_.camera.width < 32 || eyes.matched_.camera.height < 16) {
    return Problem{fmt::format("images of {} x {} are too small for stereo: 64 x 32 at least",
                               format.width, format.height)};
  }
  eyes.find_range(settings);
  return eyes;
}

StereoEyes::StereoEyes(Rectification rectification, const FrameFormat& format,
                       const DepthSettings& settings)
    : width_(format.width),
      height_(format.height),
      halved_(!settings.full_resolution && format.width > settings.full_up_to_px),
      rectification_(std::move(rectification)),
      rectified_(rectification_.geometry().stereo),
      matched_(rectified_),
      farthest_(settings.farthest.value_or(std::max(
          kUsualFarthest, rectified_.camera.fx_px * rectified_.baseline / kLeastUsualDisparity))) {
  if (!halved_) return;
  matched_.camera = rectified_.camera.scaled_down(2);
  // x_L - x_R scales with the picture; the half pixels of the two centres cancel.
  matched_.disparity_at_infinity_px = rectified_.disparity_at_infinity_px / 2;
}

void StereoEyes::find_range(const DepthSettings& settings) {
  const double f_T = matched_.camera.fx_px * matched_.baseline;
  const double infinity = matched_.disparity_at_infinity_px;
  // The range is extended by one at both ends, because the ends are not trusted.
  first_disparity_ = static_cast<int>(std::floor(infinity + f_T / farthest_)) - 1;
  // At a disparity of half the width or more only a strip at the border is visible to both cameras.
  last_disparity_ = std::min(static_cast<int>(std::ceil(infinity + f_T / settings.nearest)) + 1,
                             std::max(matched_.camera.width / 2, first_disparity_ + 16));
  disparities_ = (last_disparity_ - first_disparity_ + 1 + 15) / 16 * 16;
}

bool StereoEyes::fits(const Frame& frame) const {
  if (!frame.both.empty()) {
    return frame.both.width() == width_ && frame.both.height() == height_ && width_ % 2 == 0;
  }
  return frame.left.width() == width_ && frame.left.height() == height_ &&
         frame.right.width() == width_ && frame.right.height() == height_;
}

void StereoEyes::rectify(const Frame& frame, SeenFrame& seen) {
  using Eye = Rectification::Eye;
  if (!frame.both.empty()) {
    rectification_.rectify_luma(Eye::kLeft, frame.both, seen.left);
    rectification_.rectify_luma(Eye::kRight, frame.both, seen.right);
    rectification_.rectify_left(frame.both, seen.left, seen.color);
  } else {
    rectification_.rectify(Eye::kLeft, frame.left, seen.color);
    Rectification::luma(seen.color, seen.left);
    rectification_.rectify_luma(Eye::kRight, frame.right, seen.right);
  }
  if (!halved_) return;
  Rectification::halve(seen.left, seen.left_half);
  Rectification::halve(seen.right, right_half_);
}

}  // namespace palpable
