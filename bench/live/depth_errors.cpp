#include "bench/live/depth_errors.h"

#include "palpable/common/base/order_statistics.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpable::app {
namespace {

using Eigen::Vector3d;

constexpr int kRays = 4;         // across a pixel at an outline
constexpr double kFarthest = 3;  // m, that a ray is followed

}  // namespace

DepthImage errors_of(const DepthImage& measured, const MaskImage& shows, const TrueView& truth) {
  DepthImage errors(measured.width(), measured.height());
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const float error = measured.data()[i] - truth.depth.data()[i];
    const bool both = shows.data()[i] == kShowsPresser && truth.shows.data()[i] == kShowsPresser;
    errors.data()[i] = both && std::abs(error) < kSameThing ? error : kNoError;
  }
  return errors;
}

DepthImage averaged(const DepthImage& errors) {
  DepthImage means(errors.width(), errors.height());
  for (int y = 0; y < errors.height(); ++y) {
    for (int x = 0; x < errors.width(); ++x) {
      means(x, y) = kNoError;
      if (std::isnan(errors(x, y))) continue;
      float sum = 0;
      int count = 0;
      for (int v = std::max(0, y - kAverage); v <= std::min(errors.height() - 1, y + kAverage);
           ++v) {
        for (int u = std::max(0, x - kAverage); u <= std::min(errors.width() - 1, x + kAverage);
             ++u) {
          if (std::isnan(errors(u, v))) continue;
          sum += errors(u, v);
          ++count;
        }
      }
      means(x, y) = sum / static_cast<float>(count);
    }
  }
  return means;
}

Image<float> covered(const MaskImage& shows, std::span<const Capsule> things,
                     const PinholeCamera& camera) {
  Image<float> coverage(shows.width(), shows.height());
  const auto is_thing = [&](int x, int y) { return shows(x, y) == kShowsPresser; };
  for (int y = 0; y < shows.height(); ++y) {
    for (int x = 0; x < shows.width(); ++x) {
      const bool inside = is_thing(x, y);
      coverage(x, y) = inside ? 1.0f : 0.0f;
      bool is_border = false;
      for (int v = std::max(y - 1, 0); v <= std::min(y + 1, shows.height() - 1); ++v) {
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, shows.width() - 1); ++u) {
          is_border = is_border || is_thing(u, v) != inside;
        }
      }
      if (!is_border || things.empty()) continue;
      int met = 0;
      for (int k = 0; k < kRays * kRays; ++k) {
        const int across = k % kRays, down = k / kRays;
        const double u = x - 0.5 + (across + 0.5) / kRays, v = y - 0.5 + (down + 0.5) / kRays;
        const Vector3d ray((u - camera.cx_px) / camera.fx_px, (v - camera.cy_px) / camera.fy_px, 1);
        met += std::isfinite(ray_distance(things, Vector3d::Zero(), ray.normalized(), kFarthest));
      }
      coverage(x, y) = static_cast<float>(met) / (kRays * kRays);
    }
  }
  return coverage;
}

float median_error(const DepthImage& errors) {
  std::vector<double> known;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (!std::isnan(errors.data()[i])) known.push_back(static_cast<double>(errors.data()[i]));
  }
  return known.empty() ? 0 : static_cast<float>(percentile(known, 0.5));
}

}  // namespace palpable::app
