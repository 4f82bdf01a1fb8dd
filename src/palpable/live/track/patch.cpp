#include "palpable/live/track/patch.h"

#include "palpable/live/calibrate/rectification.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpable {
namespace {

constexpr int kSide = PatchTemplate::kSide;
constexpr int kReach = PatchTemplate::kReach;
constexpr int kPixels = PatchTemplate::kPixels;
constexpr int kWide = kSide + 2;        // a template with the rim that its gradients need
constexpr float kLeastContrast = 1.2F;  // grey levels; a window with less shows only noise
constexpr float kConverged = 0.015F;    // px, length of the last step
// Lower limit of the smaller eigenvalue of mean(g g^T), with the gradient g in contrasts per px.
// Below it the patch would slide along an edge.
constexpr float kLeastTexture = 0.01F;

// Bilinear value of a patch's level; outside, the value at the nearest point of its rim.
float sample(const PatchSource::Level& level, float x, float y) {
  constexpr int last = PatchSource::kSide - 2;
  x = std::clamp(x, 0.0F, static_cast<float>(last) + 0.999F);
  y = std::clamp(y, 0.0F, static_cast<float>(last) + 0.999F);
  const int ix = static_cast<int>(x);
  const int iy = static_cast<int>(y);
  const float s = x - static_cast<float>(ix);
  const float t = y - static_cast<float>(iy);
  const std::uint8_t* a = level.pixels.data() + iy * PatchSource::kSide + ix;
  const std::uint8_t* b = a + PatchSource::kSide;
  const float upper = static_cast<float>(a[0]) + s * static_cast<float>(a[1] - a[0]);
  const float lower = static_cast<float>(b[0]) + s * static_cast<float>(b[1] - b[0]);
  return upper + t * (lower - upper);
}

// Samples a kRows x kColumns window whose first pixel is at (x, y), bilinearly. The caller ensures
// that it lies inside the image.
template <int kRows, int kColumns>
void sample_window(const GrayImage& image, float x, float y, float* out) {
  const int ix = static_cast<int>(x);
  const int iy = static_cast<int>(y);
  const float s = x - static_cast<float>(ix);
  const float t = y - static_cast<float>(iy);
  std::array<float, kColumns> upper{}, lower{};
  const auto blend = [&](int row, std::array<float, kColumns>& to) {
    const std::uint8_t* p = image.row(row) + ix;
    for (int i = 0; i < kColumns; ++i) {
      const auto k = static_cast<std::size_t>(i);
      to[k] = (1 - s) * static_cast<float>(p[i]) + s * static_cast<float>(p[i + 1]);
    }
  };
  blend(iy, upper);
  for (int row = 0; row < kRows; ++row) {
    blend(iy + row + 1, lower);
    for (int i = 0; i < kColumns; ++i) {
      const auto k = static_cast<std::size_t>(i);
      out[row * kColumns + i] = (1 - t) * upper[k] + t * lower[k];
    }
    upper = lower;
  }
}

// Whether a window of `reach` pixels to each side of (x, y) lies inside an image.
bool fits(const GrayImage& image, double x, double y, int reach) {
  return x >= reach && y >= reach && x < image.width() - reach - 1 &&
         y < image.height() - reach - 1;
}

struct Moments {
  float mean;
  float deviation;
};

Moments moments(const float* values, int count) {
  float sum = 0, squares = 0;
  for (int i = 0; i < count; ++i) {
    sum += values[i];
    squares += values[i] * values[i];
  }
  const float mean = sum / static_cast<float>(count);
  return {mean, std::sqrt(std::max(squares / static_cast<float>(count) - mean * mean, 0.0F))};
}

// Makes a template from a window with its rim: values, gradients and the inverse of their normal
// matrix. False if it has too little texture to be followed.
bool make_template(PatchTemplate& patch, const std::array<float, kWide * kWide>& wide,
                   bool along_row) {
  std::size_t k = 0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x, ++k) {
      const float* p = wide.data() + (y + 1) * kWide + x + 1;
      patch.value[k] = p[0];
      patch.gx[k] = 0.5F * (p[1] - p[-1]);
      patch.gy[k] = 0.5F * (p[kWide] - p[-kWide]);
    }
  }
  const auto [mean, deviation] = moments(patch.value.data(), kPixels);
  patch.contrast = deviation;
  if (deviation < kLeastContrast) return false;
  const float scale = 1 / deviation;
  const float mean_gx = moments(patch.gx.data(), kPixels).mean;
  const float mean_gy = moments(patch.gy.data(), kPixels).mean;
  float xx = 0, xy = 0, yy = 0;
  for (k = 0; k < kPixels; ++k) {
    patch.value[k] = (patch.value[k] - mean) * scale;
    // The mean is subtracted from the image as well, so a gradient that is common to all pixels
    // does not help to find the position.
    patch.gx[k] = (patch.gx[k] - mean_gx) * scale;
    patch.gy[k] = (patch.gy[k] - mean_gy) * scale;
    xx += patch.gx[k] * patch.gx[k];
    xy += patch.gx[k] * patch.gy[k];
    yy += patch.gy[k] * patch.gy[k];
  }
  if (along_row) {
    if (xx < kLeastTexture * kPixels) return false;
    patch.h_xx = 1 / xx;
    patch.h_xy = patch.h_yy = 0;
    return true;
  }
  const float det = xx * yy - xy * xy;
  const float half = 0.5F * (xx + yy);
  const float least = half - std::sqrt(std::max(half * half - det, 0.0F));
  if (least < kLeastTexture * kPixels) return false;
  patch.h_xx = yy / det;
  patch.h_xy = -xy / det;
  patch.h_yy = xx / det;
  return true;
}

// Fills `window` with the image around (x, y), scaled to mean 0 and deviation 1.
// @return its likeness to the template
float compare(const GrayImage& image, const PatchTemplate& patch, float x, float y,
              std::array<float, kPixels>& window) {
  sample_window<kSide, kSide>(image, x - kReach, y - kReach, window.data());
  const auto [mean, deviation] = moments(window.data(), kPixels);
  const float scale = deviation > 1e-3F ? 1 / deviation : 0.0F;
  float sum = 0;
  for (std::size_t k = 0; k < kPixels; ++k) {
    window[k] = (window[k] - mean) * scale;
    sum += window[k] * patch.value[k];
  }
  return sum / kPixels;
}

}  // namespace

void Pyramid::build(const GrayImage& full) {
  full_ = &full;
  const GrayImage* from = full_;
  for (GrayImage& half : halves_) {
    Rectification::halve(*from, half);
    from = &half;
  }
}

PatchSource PatchSource::cut(const Pyramid& image, const Eigen::Vector2d& uv) {
  PatchSource source;
  for (int l = 0; l < Pyramid::kLevels; ++l) {
    Level& to = source.levels[l];
    const GrayImage& from = image.level(l);
    const Eigen::Vector2d c = Pyramid::to_level(uv, l);
    const int x0 = static_cast<int>(std::floor(c.x())) - kSide / 2 + 1;
    const int y0 = static_cast<int>(std::floor(c.y())) - kSide / 2 + 1;
    to.cx = static_cast<float>(c.x() - x0);
    to.cy = static_cast<float>(c.y() - y0);
    to.usable = fits(from, c.x(), c.y(), kReach + 1);
    for (int y = 0; y < kSide; ++y) {
      const std::uint8_t* row = from.row(std::clamp(y0 + y, 0, from.height() - 1));
      for (int x = 0; x < kSide; ++x) {
        to.pixels[y * kSide + x] = row[std::clamp(x0 + x, 0, from.width() - 1)];
      }
    }
  }
  return source;
}

bool PatchTemplate::warp(const PatchSource& source, int level,
                         const Eigen::Matrix2d& image_from_source, const Eigen::Vector2d& smear) {
  const double det = image_from_source.determinant();
  if (!(det > 0.02 && det < 50)) return false;
  // A patch that appears s times as large is taken from the level at which it has that size.
  const int from_level = std::clamp(level - static_cast<int>(std::lround(0.5 * std::log2(det))), 0,
                                    Pyramid::kLevels - 1);
  const PatchSource::Level& from = source.levels[from_level];
  if (!from.usable) return false;
  const double scale = std::ldexp(1.0, level - from_level);
  const Eigen::Matrix2f M = (image_from_source.inverse() * scale).cast<float>();

  const double length = smear.norm();
  const int blur = length < 0.7 ? 1 : std::min(static_cast<int>(std::ceil(length)) + 1, 9);
  std::array<float, kWide * kWide> wide{};
  for (int b = 0; b < blur; ++b) {
    // Instants of the exposure, evenly spaced and symmetric about its middle.
    const float share =
        blur == 1 ? 0.0F : (static_cast<float>(b) + 0.5F) / static_cast<float>(blur) - 0.5F;
    const Eigen::Vector2f shift = share * smear.cast<float>();
    std::size_t k = 0;
    for (int y = 0; y < kWide; ++y) {
      const Eigen::Vector2f first =
          M * (Eigen::Vector2f(-kReach - 1, static_cast<float>(y - kReach - 1)) + shift);
      float sx = from.cx + first.x();
      float sy = from.cy + first.y();
      for (int x = 0; x < kWide; ++x, ++k) {
        wide[k] += sample(from, sx, sy);
        sx += M(0, 0);
        sy += M(1, 0);
      }
    }
  }
  if (blur > 1) {
    for (float& w : wide) w /= static_cast<float>(blur);
  }
  return make_template(*this, wide, false);
}

bool PatchTemplate::cut(const GrayImage& image, double x, double y) {
  if (!fits(image, x, y, kReach + 1)) return false;
  std::array<float, kWide * kWide> wide{};
  sample_window<kWide, kWide>(image, static_cast<float>(x) - kReach - 1,
                              static_cast<float>(y) - kReach - 1, wide.data());
  return make_template(*this, wide, true);
}

PatchMatch follow(const GrayImage& image, const PatchTemplate& patch, const Eigen::Vector2d& start,
                  const PatchSearch& search) {
  PatchMatch match;
  std::array<float, kPixels> window{};
  auto x = static_cast<float>(start.x());
  auto y = static_cast<float>(start.y());
  bool converged = false;
  for (int step = 0; step < search.steps; ++step) {
    if (!fits(image, static_cast<double>(x), static_cast<double>(y), kReach)) return match;
    match.likeness = static_cast<double>(compare(image, patch, x, y, window));
    float bx = 0, by = 0;
    for (std::size_t k = 0; k < kPixels; ++k) {
      const float e = window[k] - patch.value[k];
      bx += patch.gx[k] * e;
      by += patch.gy[k] * e;
    }
    const float dx = patch.h_xx * bx + patch.h_xy * by;
    const float dy = search.along_row ? 0.0F : patch.h_xy * bx + patch.h_yy * by;
    x -= dx;
    y -= dy;
    const double far = search.farthest;
    if (!(std::abs(static_cast<double>(x) - start.x()) <= far &&
          std::abs(static_cast<double>(y) - start.y()) <= far)) {
      return match;
    }
    if (dx * dx + dy * dy < kConverged * kConverged) {
      converged = true;
      break;
    }
  }
  match.at = {static_cast<double>(x), static_cast<double>(y)};
  if (!fits(image, match.at.x(), match.at.y(), kReach)) return match;
  match.likeness = static_cast<double>(compare(image, patch, x, y, window));
  match.found = converged || match.likeness > 0.9;
  return match;
}

double likeness_at(const GrayImage& image, const PatchTemplate& patch, const Eigen::Vector2d& at) {
  if (!fits(image, at.x(), at.y(), kReach)) return -1;
  std::array<float, kPixels> window{};
  return static_cast<double>(
      compare(image, patch, static_cast<float>(at.x()), static_cast<float>(at.y()), window));
}

}  // namespace palpable
