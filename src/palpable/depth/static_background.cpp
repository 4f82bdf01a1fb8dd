#include "palpable/depth/static_background.h"

#include "palpable/base/contract.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

namespace palpable {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

// The median of |x - median| of a normal distribution is 0.6745 sigma.
constexpr double kSigmaPerMad = 1.4826;
constexpr double kLargestScatter = 3;  // times the sensor's sigma

// Of an even number of values the lower of the middle two: one of the depths that were seen.
float lower_median(std::span<float> values) {
  const auto middle = values.begin() + (std::ssize(values) - 1) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

StaticBackground::StaticBackground(const DepthNoise& noise,
                                   const StaticBackgroundSettings& settings)
    : noise_(noise), settings_(settings) {
  PALPABLE_EXPECT(settings.frames >= 1 && settings.frames <= 255,
                  "a background is learnt from 1 to 255 frames");
  PALPABLE_EXPECT(settings.sigmas >= 0 && settings.edge_window_px >= 0,
                  "a tolerance and a window are not negative");
  seen_.reserve(settings.frames);
}

void StaticBackground::learn(const DepthImage& depth) {
  if (ready()) return;
  PALPABLE_EXPECT(seen_.empty() || (depth.width() == seen_.front().width() &&
                                    depth.height() == seen_.front().height()),
                  "a background is learnt from images of one size");
  seen_.push_back(depth);
  if (++learnt_ == settings_.frames) finish();
}

void StaticBackground::finish() {
  const int width = seen_.front().width();
  const int height = seen_.front().height();
  const int wanted = std::max(1, static_cast<int>(std::ceil(settings_.seen_share * learnt_)));
  const float infinity = std::numeric_limits<float>::infinity();

  median_ = DepthImage(width, height, kUnknown);
  DepthImage limit(width, height, infinity);
  std::array<float, 255> values{};
  for (std::size_t i = 0; i < median_.size(); ++i) {
    std::size_t count = 0;
    for (const DepthImage& image : seen_) {
      const float Z = image.data()[i];
      if (Z == Z) values[count++] = Z;
    }
    if (static_cast<int>(count) < wanted) continue;
    const std::span<float> seen(values.data(), count);
    const float Z = lower_median(seen);
    for (float& value : seen) value = std::abs(value - Z);
    const double sensor = noise_.sigma(Z);
    const double scatter = kSigmaPerMad * lower_median(seen);
    median_.data()[i] = Z;
    limit.data()[i] = static_cast<float>(
        Z - settings_.sigmas * std::clamp(scatter, sensor, kLargestScatter * sensor));
  }

  // Smallest in the window: along rows, then along columns.
  const int reach = settings_.edge_window_px;
  DepthImage along_rows(width, height, infinity);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int k = std::max(0, x - reach); k <= std::min(width - 1, x + reach); ++k) {
        along_rows(x, y) = std::min(along_rows(x, y), limit(k, y));
      }
    }
  }
  keep_below_ = DepthImage(width, height, infinity);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int k = std::max(0, y - reach); k <= std::min(height - 1, y + reach); ++k) {
        keep_below_(x, y) = std::min(keep_below_(x, y), along_rows(x, k));
      }
    }
  }
  seen_.clear();
  seen_.shrink_to_fit();
}

void StaticBackground::remove_static(DepthImage& depth) const {
  PALPABLE_EXPECT(ready(), "a background is learnt before it is removed");
  PALPABLE_EXPECT(depth.width() == keep_below_.width() && depth.height() == keep_below_.height(),
                  "the background has the size of the images that it is removed from");
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (!(depth.data()[i] < keep_below_.data()[i])) depth.data()[i] = kUnknown;
  }
}

void StaticBackground::remove_static(DepthImage& depth, const PinholeCamera& camera,
                                     const Rigid3& now_from_learnt) {
  PALPABLE_EXPECT(ready(), "a background is learnt before it is removed");
  PALPABLE_EXPECT(depth.width() == keep_below_.width() && depth.height() == keep_below_.height(),
                  "the background has the size of the images that it is removed from");
  // Nothing is nearer than 0: what no point of the background falls on is background.
  moved_.resize(depth.width(), depth.height());
  std::fill(moved_.begin(), moved_.end(), 0.0F);
  const Eigen::Matrix3f R = now_from_learnt.linear().cast<float>();
  const Eigen::Vector3f t = now_from_learnt.translation().cast<float>();
  const auto fx = static_cast<float>(camera.fx_px), fy = static_cast<float>(camera.fy_px);
  const auto cx = static_cast<float>(camera.cx_px), cy = static_cast<float>(camera.cy_px);
  for (int y = 0; y < depth.height(); ++y) {
    for (int x = 0; x < depth.width(); ++x) {
      const float Z = keep_below_(x, y);
      const Eigen::Vector3f ray((static_cast<float>(x) - cx) / fx,
                                (static_cast<float>(y) - cy) / fy, 1);
      // What had no depth is taken to lie far away: there everything is new, wherever it is.
      const bool far = !std::isfinite(Z);
      const Eigen::Vector3f at =
          far ? Eigen::Vector3f(R * ray) : Eigen::Vector3f(Z * (R * ray) + t);
      if (!(at.z() > 0.01F)) continue;
      // A point of one pixel fills four, so that a small zoom leaves no gaps between them.
      const float u = fx * at.x() / at.z() + cx;
      const float v = fy * at.y() / at.z() + cy;
      if (!(u >= 0 && v >= 0 && u < static_cast<float>(depth.width() - 1) &&
            v < static_cast<float>(depth.height() - 1))) {
        continue;
      }
      const int iu = static_cast<int>(u), iv = static_cast<int>(v);
      for (float* to :
           {&moved_(iu, iv), &moved_(iu + 1, iv), &moved_(iu, iv + 1), &moved_(iu + 1, iv + 1)}) {
        const float limit = far ? Z : at.z();
        if (*to == 0 || limit < *to) *to = limit;
      }
    }
  }
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (!(depth.data()[i] < moved_.data()[i])) depth.data()[i] = kUnknown;
  }
}

}  // namespace palpable
