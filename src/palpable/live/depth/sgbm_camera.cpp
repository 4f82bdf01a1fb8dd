#include "palpable/live/depth/sgbm_camera.h"

#include "palpable/live/calibrate/opencv_views.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace palpable {
namespace {

constexpr int kSubpixels = 16;  // OpenCV's unit of disparities is 1/16 px

// Block size and penalties of the reference settings (research/vision.md): P1 for a step of one
// pixel, P2 for a jump, in OpenCV's unit (per channel and block pixel).
constexpr int kBlock = 5;
constexpr int kP1 = 8 * kBlock * kBlock;
constexpr int kP2 = 32 * kBlock * kBlock;
constexpr int kUniquenessPercent = 5;
constexpr int kLargestLeftRightDifference = 1;  // px between the left view's match and the right's

// A table from disparity to depth, in steps of 1/16 px from the first searched disparity on; NaN
// where the matcher is not trusted.
std::vector<float> depth_table(const StereoEyes& eyes) {
  const int disparities = eyes.disparities();
  std::vector<float> depth_of(disparities * kSubpixels, std::numeric_limits<float>::quiet_NaN());
  // A minimum at either end of the range is left out: the true minimum may lie outside.
  for (int i = kSubpixels; i <= (disparities - 2) * kSubpixels; ++i) {
    const double Z =
        eyes.matched().depth(eyes.first_disparity() + static_cast<double>(i) / kSubpixels);
    if (Z > 0 && Z <= eyes.farthest()) depth_of[i] = static_cast<float>(Z);
  }
  return depth_of;
}

}  // namespace

struct SgbmCamera::Parts {
  StereoEyes eyes;
  DepthNoise noise;
  std::vector<float> depth_of;  // depth_table()
  cv::Ptr<cv::StereoSGBM> matcher;
  cv::Mat left_padded;
  cv::Mat right_padded;
  cv::Mat disparity;  // CV_16SC1, sixteenths

  Parts(StereoEyes eyes_of, const DepthSettings& settings)
      : eyes(std::move(eyes_of)),
        noise(eyes.noise()),
        depth_of(depth_table(eyes)),
        matcher(cv::StereoSGBM::create(eyes.first_disparity(), eyes.disparities(), kBlock, kP1, kP2,
                                       kLargestLeftRightDifference, 63, kUniquenessPercent,
                                       settings.speckle_size_px, 1,
                                       cv::StereoSGBM::MODE_SGBM_3WAY)) {}

  // OpenCV does not compute the columns x < first + disparities (and, if first < 0, the last -first
  // columns). Padding moves those columns out of the picture.
  [[nodiscard]] int pad_left() const {
    return std::max(eyes.first_disparity() + eyes.disparities(), 0);
  }
  [[nodiscard]] int pad_right() const { return std::max(-eyes.first_disparity(), 0); }

  void match(const SeenFrame& seen);
  void fill_depth(DepthImage& depth) const;
};

void SgbmCamera::Parts::match(const SeenFrame& seen) {
  cv::copyMakeBorder(view(eyes.left(seen)), left_padded, 0, 0, pad_left(), pad_right(),
                     cv::BORDER_REPLICATE);
  cv::copyMakeBorder(view(eyes.right(seen)), right_padded, 0, 0, pad_left(), pad_right(),
                     cv::BORDER_REPLICATE);
  matcher->compute(left_padded, right_padded, disparity);
}

void SgbmCamera::Parts::fill_depth(DepthImage& depth) const {
  const int width = depth.width();
  const int first = eyes.first_disparity() * kSubpixels;
  const int count = eyes.disparities() * kSubpixels;
  for (int y = 0; y < depth.height(); ++y) {
    const auto* d = disparity.ptr<std::int16_t>(y) + pad_left();
    float* Z = depth.row(y);
    for (int x = 0; x < width; ++x) {
      const int i = d[x] - first;  // negative where the matcher found nothing
      // A match whose partner lies outside the right image is an extrapolation, and is left out.
      const int partner = x * kSubpixels - d[x];
      const bool seen_by_both = partner >= 0 && partner <= (width - 1) * kSubpixels;
      Z[x] = i >= 0 && i < count && seen_by_both ? depth_of[i]
                                                 : std::numeric_limits<float>::quiet_NaN();
    }
  }
}

SgbmCamera::SgbmCamera(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
SgbmCamera::SgbmCamera(SgbmCamera&&) noexcept = default;
SgbmCamera& SgbmCamera::operator=(SgbmCamera&&) noexcept = default;
SgbmCamera::~SgbmCamera() = default;

Result<SgbmCamera> SgbmCamera::make(const FrameFormat& format, const DepthSettings& settings) {
  Result<StereoEyes> eyes = StereoEyes::make(format, settings);
  if (!eyes.ok()) return eyes.problem();
  try {
    return SgbmCamera(std::make_unique<Parts>(std::move(eyes).value(), settings));
  } catch (const cv::Exception& e) { return Problem{"no matcher for this rig: " + e.err}; }
}

bool SgbmCamera::measure(const Frame& frame, SeenFrame& seen, StageTimes& times) {
  if (!parts_->eyes.fits(frame)) return false;
  {
    const StageTimer timer(times, "rectify");
    parts_->eyes.rectify(frame, seen);
  }
  {
    const StageTimer timer(times, "disparity");
    parts_->match(seen);
  }
  const StageTimer timer(times, "depth");
  parts_->fill_depth(seen.depth);
  // Its table has no depths beyond the limits: what was measured is what is kept.
  const auto known =
      std::count_if(seen.depth.begin(), seen.depth.end(), [](float Z) { return Z > 0; });
  seen.measured.measured =
      static_cast<double>(known) / static_cast<double>(std::max<std::size_t>(seen.depth.size(), 1));
  const int height = seen.depth.height();
  for (int y = 0; y < height; y += sample_step(height)) {
    for (int x = 0; x < seen.depth.width(); ++x) seen.measured.sample(seen.depth(x, y));
  }
  return true;
}

const PinholeCamera& SgbmCamera::camera() const { return parts_->eyes.rectified().camera; }
const PinholeCamera& SgbmCamera::depth_camera() const { return parts_->eyes.matched().camera; }
const RectifiedStereo& SgbmCamera::rectified() const { return parts_->eyes.rectified(); }
const DepthNoise& SgbmCamera::noise() const { return parts_->noise; }

}  // namespace palpable
