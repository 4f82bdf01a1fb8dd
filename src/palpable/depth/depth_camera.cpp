#include "palpable/depth/depth_camera.h"

#include "palpable/base/contract.h"
#include "palpable/calibrate/calibration_file.h"
#include "palpable/calibrate/opencv_views.h"
#include "palpable/calibrate/rectification.h"
#include "palpable/depth/depth_registration.h"
#include "palpable/stereo/row_watch.h"
#include "palpable/stereo/stereo_matcher.h"

#include <fmt/core.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace palpable {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
// The guard looks for things down to here, m: at 40 mm neither eye is in focus.
constexpr double kGuardNearest = 0.05;

constexpr int kMostThreads = 16;

constexpr int kSubpixels = 16;  // OpenCV's disparities come in sixteenths of a pixel

// Cost block and penalties of the reference settings (research/vision.md): P1 for a step of one
// pixel, P2 for a jump; per channel and block pixel as OpenCV counts them.
constexpr int kBlock = 5;
constexpr int kP1 = 8 * kBlock * kBlock;
constexpr int kP2 = 32 * kBlock * kBlock;
constexpr int kUniquenessPercent = 5;
constexpr int kLargestLeftRightDifference = 1;  // px between the left view's match and the right's

bool has_size(const ColorImage& image, int width, int height) {
  return image.width() == width && image.height() == height;
}

std::optional<Problem> what_is_wrong_with_camera(const PinholeCamera& camera, const char* which) {
  if (camera.fx_px > 0 && camera.fy_px > 0 &&
      std::isfinite(camera.fx_px + camera.fy_px + camera.cx_px + camera.cy_px)) {
    return std::nullopt;
  }
  return Problem{
      fmt::format("the {} camera's focal lengths are {} and {} px; they should be "
                  "positive",
                  which, camera.fx_px, camera.fy_px)};
}

}  // namespace

struct DepthCamera::Parts {
  FrameFormat format;
  DepthSettings settings;
  PinholeCamera camera;
  PinholeCamera depth_camera;
  DepthNoise noise;
  StageTimes times;

  // Colour + depth whose sensors are two.
  std::optional<DepthRegistration> registration;
  DepthImage own_view;  // of the depth sensor

  // Stereo only.
  std::optional<Rectification> rectification;
  RectifiedStereo stereo;   // the rectified rig
  RectifiedStereo matched;  // the same at the resolution of matching
  int first_disparity = 0;  // px
  int disparities = 0;      // multiple of 16
  GrayImage right_half;

  // kCensus
  std::optional<StereoMatcher> own;
  MatchedPair pair;
  std::optional<RowWatch> watch;
  double row_correction_px = 0;
  bool fit_is_known = false;  // asked of the first frame alone: it takes time and memory

  // kOpenCv
  std::vector<float> depth_of;  // by disparity in sixteenths, from first_disparity on
  cv::Ptr<cv::StereoSGBM> opencv;
  cv::Mat left_padded;
  cv::Mat right_padded;
  cv::Mat disparity;  // CV_16SC1, sixteenths

  void find_range();
  void prepare_own();
  void prepare_opencv();
  void see_stereo(const Frame& frame, SeenFrame& seen);
  void rectify(const Frame& frame, SeenFrame& seen);
  void match_own(SeenFrame& seen);
  void watch_rows(SeenFrame& seen);
  void match_opencv(SeenFrame& seen);
};

void DepthCamera::Parts::find_range() {
  const double f_T = matched.camera.fx_px * matched.baseline;
  const double infinity = matched.disparity_at_infinity_px;
  // One less and one more than the range needs, because neither end is trusted.
  first_disparity = static_cast<int>(std::floor(infinity + f_T / settings.farthest)) - 1;
  // What both eyes see at a disparity of half the width or more is a strip at the border.
  const int last = std::min(static_cast<int>(std::ceil(infinity + f_T / settings.nearest)) + 1,
                            std::max(matched.camera.width / 2, first_disparity + 16));
  disparities = (last - first_disparity + 1 + 15) / 16 * 16;
}

void DepthCamera::Parts::prepare_own() {
  StereoMatcherSettings s = settings.full_resolution ? full_matching() : near_matching();
  s.first = first_disparity;
  const int most = (kMostDisparities - 1 - std::abs(first_disparity)) / 16 * 16;
  s.disparities = disparities = std::min(disparities, most);
  const double f_T = matched.camera.fx_px * matched.baseline;
  // At a quarter of the resolution, from the same end of the range on.
  const double widest = matched.camera.width;
  s.guard_disparities =
      static_cast<int>(std::min(f_T / kGuardNearest + std::abs(first_disparity), widest) / 4);
  s.guard_disparities = std::min(s.guard_disparities, most);
  s.threads = settings.threads;
  own.emplace(s);
  if (settings.watch_rows) watch.emplace(camera);
}

void DepthCamera::Parts::prepare_opencv() {
  opencv = cv::StereoSGBM::create(first_disparity, disparities, kBlock, kP1, kP2,
                                  kLargestLeftRightDifference, 63, kUniquenessPercent,
                                  settings.speckle_size_px, 1, cv::StereoSGBM::MODE_SGBM_3WAY);

  depth_of.resize(static_cast<std::size_t>(disparities * kSubpixels), kUnknown);
  // A minimum at either end of the range has only one neighbour: the true one may lie outside.
  for (int i = kSubpixels; i <= (disparities - 2) * kSubpixels; ++i) {
    const double Z = matched.depth(first_disparity + static_cast<double>(i) / kSubpixels);
    if (Z > 0 && Z <= settings.farthest) {
      depth_of[static_cast<std::size_t>(i)] = static_cast<float>(Z);
    }
  }
}

void DepthCamera::Parts::see_stereo(const Frame& frame, SeenFrame& seen) {
  {
    const StageTimer timer(times, "rectify");
    rectify(frame, seen);
  }
  if (own) {
    match_own(seen);
  } else {
    match_opencv(seen);
  }
}

void DepthCamera::Parts::rectify(const Frame& frame, SeenFrame& seen) {
  using Eye = Rectification::Eye;
  rectification->rectify(Eye::kLeft, frame.left, seen.color);
  Rectification::luma(seen.color, seen.left);
  rectification->rectify_luma(Eye::kRight, frame.right, seen.right);
  if (settings.full_resolution) return;
  Rectification::halve(seen.left, seen.left_half);
  Rectification::halve(seen.right, right_half);
}

void DepthCamera::Parts::match_own(SeenFrame& seen) {
  {
    const StageTimer timer(times, "disparity");
    if (settings.full_resolution) {
      own->match(seen.left, seen.right, pair);
    } else {
      own->match(seen.left_half, right_half, pair);
      own->refine(seen.left, seen.right, pair);
    }
  }
  const StageTimer timer(times, "depth");
  if (watch) watch_rows(seen);
  const auto f_T = static_cast<float>(kDisparitySteps * matched.camera.fx_px * matched.baseline);
  const auto infinity = static_cast<float>(kDisparitySteps * matched.disparity_at_infinity_px);
  const auto farthest = static_cast<float>(settings.farthest);
  for (std::size_t i = 0; i < seen.depth.size(); ++i) {
    const std::int16_t d = pair.disparity.data()[i];
    const float Z = f_T / (static_cast<float>(d) - infinity);
    const bool known = is_measured(d) && Z > 0 && Z <= farthest;
    seen.depth.data()[i] = known ? Z : kUnknown;
    seen.confidence.data()[i] = known ? pair.confidence.data()[i] : std::uint8_t{0};
    seen.too_close.data()[i] = d == kTooCloseDisparity ? 255 : 0;
  }
}

// What is found now helps from the next frame on.
void DepthCamera::Parts::watch_rows(SeenFrame& seen) {
  const RowError& error = watch->measure(seen.left, seen.right, pair.disparity, pair.confidence,
                                         settings.full_resolution ? 1 : 2);
  seen.row_error_px = error.median_px;
  if (std::isnan(error.median_px) && !fit_is_known) {
    const int factor = settings.full_resolution ? 1 : 2;
    const GrayImage& l = settings.full_resolution ? seen.left : seen.left_half;
    const GrayImage& r = settings.full_resolution ? seen.right : right_half;
    seen.misfit = misfit_of(l, r, static_cast<int>(std::lround(matched.disparity_at_infinity_px)),
                            std::max(disparities, 1));
    if (seen.misfit) seen.misfit->rows_px *= factor;
  }
  fit_is_known = true;
  if (const std::optional<EyeTilt> due = watch->correction_due()) {
    rectification->turn_right(due->rotation());
    row_correction_px += due->pitch * camera.fy_px;
  }
}

void DepthCamera::Parts::match_opencv(SeenFrame& seen) {
  const GrayImage& l = settings.full_resolution ? seen.left : seen.left_half;
  const GrayImage& r = settings.full_resolution ? seen.right : right_half;
  // OpenCV computes no column x < first + disparities (and, if first < 0, none of the last -first):
  // padding moves those columns out of the picture.
  const int pad_left = std::max(first_disparity + disparities, 0);
  const int pad_right = std::max(-first_disparity, 0);
  {
    const StageTimer timer(times, "disparity");
    cv::copyMakeBorder(view(l), left_padded, 0, 0, pad_left, pad_right, cv::BORDER_REPLICATE);
    cv::copyMakeBorder(view(r), right_padded, 0, 0, pad_left, pad_right, cv::BORDER_REPLICATE);
    opencv->compute(left_padded, right_padded, disparity);
  }
  const StageTimer timer(times, "depth");
  const int width = matched.camera.width;
  const int height = matched.camera.height;
  const int first = first_disparity * kSubpixels;
  const int count = disparities * kSubpixels;
  for (int y = 0; y < height; ++y) {
    const auto* d = disparity.ptr<std::int16_t>(y) + pad_left;
    float* Z = seen.depth.row(y);
    for (int x = 0; x < width; ++x) {
      const int i = d[x] - first;  // negative where the matcher found nothing
      // A partner outside of the right image was never seen: such a match is a guess.
      const int partner = x * kSubpixels - d[x];
      const bool seen_by_both = partner >= 0 && partner <= (width - 1) * kSubpixels;
      Z[x] = i >= 0 && i < count && seen_by_both ? depth_of[static_cast<std::size_t>(i)] : kUnknown;
    }
  }
}

DepthCamera::DepthCamera(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
DepthCamera::DepthCamera(DepthCamera&&) noexcept = default;
DepthCamera& DepthCamera::operator=(DepthCamera&&) noexcept = default;
DepthCamera::~DepthCamera() = default;

Result<DepthCamera> DepthCamera::make(const FrameFormat& format, const DepthSettings& settings) {
  if (!(settings.nearest > 0 && settings.farthest > settings.nearest &&
        std::isfinite(settings.farthest))) {
    return Problem{
        fmt::format("depth is searched from {} m to {} m; both should be positive and "
                    "the second larger",
                    settings.nearest, settings.farthest)};
  }
  auto parts = std::make_unique<Parts>();
  parts->format = format;
  parts->settings = settings;
  if (format.kind == FrameFormat::Kind::kColorDepth) {
    if (auto problem = what_is_wrong_with_camera(format.depth_camera, "depth")) return *problem;
    parts->camera = format.depth_camera;
    if (format.color_sensor) {
      const ColorSensor& color = *format.color_sensor;
      if (auto problem = what_is_wrong_with_camera(color.camera, "colour")) return *problem;
      if (color.camera.width != format.width || color.camera.height != format.height) {
        return Problem{fmt::format("the images are {} x {} but the colour camera is {} x {}",
                                   format.width, format.height, color.camera.width,
                                   color.camera.height)};
      }
      if (!color.color_from_depth.matrix().allFinite()) {
        return Problem{"how the colour camera stands to the depth camera is not finite"};
      }
      parts->camera = color.camera;
      parts->registration.emplace(format.depth_camera, color);
    }
    parts->depth_camera = parts->camera;
    parts->noise = time_of_flight_noise();
    return DepthCamera(std::move(parts));
  }

  const PinholeCamera& given =
      format.already_rectified ? format.rectified.camera : format.rig.left.pinhole;
  if (given.width != format.width || given.height != format.height) {
    return Problem{fmt::format("the images are {} x {} but the calibration is for {} x {}",
                               format.width, format.height, given.width, given.height)};
  }
  if (format.already_rectified) {
    const std::string wrong = what_is_wrong_with(format.rectified);
    if (!wrong.empty()) return Problem{wrong};
    parts->rectification.emplace(format.rectified);
  } else {
    const Result<RectifiedGeometry> geometry = rectify_rig(format.rig);
    if (!geometry.ok()) return geometry.problem();
    parts->rectification.emplace(format.rig);
  }
  const RectifiedStereo& stereo = parts->rectification->geometry().stereo;
  parts->camera = stereo.camera;
  parts->stereo = parts->matched = stereo;
  if (!settings.full_resolution) {
    parts->matched.camera = stereo.camera.scaled_down(2);
    // x_L - x_R shrinks with the picture; the half pixels of the two centres cancel.
    parts->matched.disparity_at_infinity_px = stereo.disparity_at_infinity_px / 2;
  }
  parts->depth_camera = parts->matched.camera;
  parts->noise = stereo_noise(parts->matched);
  if (parts->matched.camera.width < 32 || parts->matched.camera.height < 16) {
    return Problem{fmt::format("images of {} x {} are too small for stereo: 64 x 32 at least",
                               format.width, format.height)};
  }
  parts->find_range();
  if (settings.matcher == DepthSettings::Matcher::kCensus) {
    if (settings.threads < 1 || settings.threads > kMostThreads) {
      return Problem{fmt::format("matching on {} threads: 1 to {} are possible", settings.threads,
                                 kMostThreads)};
    }
    if (std::abs(parts->first_disparity) > kMostDisparities / 2) {
      return Problem{fmt::format("the disparity at infinity is {} px; the matcher reaches {}",
                                 parts->matched.disparity_at_infinity_px, kMostDisparities / 2)};
    }
    parts->prepare_own();
    return DepthCamera(std::move(parts));
  }
  try {
    parts->prepare_opencv();
  } catch (const cv::Exception& e) { return Problem{"no matcher for this rig: " + e.err}; }
  return DepthCamera(std::move(parts));
}

void DepthCamera::see(const Frame& frame, SeenFrame& seen) {
  Parts& p = *parts_;
  p.times.clear();
  seen.number = frame.number;
  seen.time = frame.time;
  seen.camera = p.camera;
  seen.depth_camera = p.depth_camera;
  seen.row_error_px = std::numeric_limits<double>::quiet_NaN();
  seen.row_correction_px = p.row_correction_px;
  seen.misfit.reset();
  seen.color.resize(p.camera.width, p.camera.height);
  seen.depth.resize(p.depth_camera.width, p.depth_camera.height);
  if (p.own) {
    seen.too_close.resize(p.depth_camera.width, p.depth_camera.height);
    seen.confidence.resize(p.depth_camera.width, p.depth_camera.height);
  }

  const int width = p.format.width;
  const int height = p.format.height;
  bool usable = has_size(frame.left, width, height);
  if (p.format.kind == FrameFormat::Kind::kColorDepth) {
    usable = usable && frame.depth.width() == width && frame.depth.height() == height;
    if (usable) {
      const StageTimer timer(p.times, "depth");
      std::copy(frame.left.begin(), frame.left.end(), seen.color.begin());
      Rectification::luma(seen.color, seen.left);
      DepthImage& known = p.registration ? p.own_view : seen.depth;
      known.resize(width, height);
      std::transform(frame.depth.begin(), frame.depth.end(), known.begin(), [&](float Z) {
        return Z > 0 && Z <= p.settings.farthest ? Z : kUnknown;  // NaN: unknown stays unknown
      });
      if (p.registration) p.registration->to_color(p.own_view, seen.depth);
    }
  } else {
    usable = usable && has_size(frame.right, width, height);
    if (usable) {
      try {
        p.see_stereo(frame, seen);
      } catch (const cv::Exception&) {
        usable = false;  // of a library that ran out of memory, say: this frame has no depth
      }
    }
  }
  if (usable) return;
  seen.left.resize(0, 0);
  seen.left_half.resize(0, 0);
  seen.right.resize(0, 0);
  std::fill(seen.color.begin(), seen.color.end(), Rgb{});
  std::fill(seen.depth.begin(), seen.depth.end(), kUnknown);
  std::fill(seen.too_close.begin(), seen.too_close.end(), std::uint8_t{0});
  std::fill(seen.confidence.begin(), seen.confidence.end(), std::uint8_t{0});
}

const PinholeCamera& DepthCamera::camera() const { return parts_->camera; }
const PinholeCamera& DepthCamera::depth_camera() const { return parts_->depth_camera; }
const RectifiedStereo& DepthCamera::rectified() const { return parts_->stereo; }
const DepthNoise& DepthCamera::noise() const { return parts_->noise; }
const StageTimes& DepthCamera::last_times() const { return parts_->times; }

}  // namespace palpable
