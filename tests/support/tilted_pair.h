/// @file
/// A textured wall seen by two rectified eyes, of which the right one is slightly rotated.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/live/stereo/row_watch.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <cstdint>

namespace palpable::test {

inline constexpr int kTiltedWidth = 640;
inline constexpr int kTiltedHeight = 360;
inline constexpr double kTiltedDisparity = 24;  ///< px, of the whole wall

inline RectifiedStereo tilted_stereo() {
  return {{kTiltedWidth, kTiltedHeight, 350, 350, 319.5, 179.5}, 0.063, 0};
}

struct TiltedPair {
  GrayImage left;
  GrayImage right;
};

/// A texture that is blurred enough to be interpolated; CV_32FC1, wider than the pair.
inline cv::Mat blurred_texture(unsigned seed) {
  cv::RNG random(seed);
  cv::Mat image(kTiltedHeight, kTiltedWidth + 200, CV_32FC1);
  random.fill(image, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(image, image, cv::Size(0, 0), 1.8);
  cv::normalize(image, image, 20, 235, cv::NORM_MINMAX);
  return image;
}

inline GrayImage rounded(const cv::Mat& gray) {
  GrayImage image(kTiltedWidth, kTiltedHeight);
  for (int y = 0; y < kTiltedHeight; ++y) {
    for (int x = 0; x < kTiltedWidth; ++x) {
      image(x, y) = static_cast<std::uint8_t>(std::lround(gray.at<float>(y, x)));
    }
  }
  return image;
}

/// The wall's pair with the right eye rotated by the inverse of `tilt`, so that a correction by
/// `tilt` aligns it.
inline TiltedPair tilted_pair(const EyeTilt& tilt, unsigned seed) {
  const cv::Mat texture = blurred_texture(seed);
  const PinholeCamera c = tilted_stereo().camera;
  const Eigen::Matrix3d aligned_from_tilted = tilt.rotation();
  cv::Mat x(kTiltedHeight, kTiltedWidth, CV_32FC1), y(kTiltedHeight, kTiltedWidth, CV_32FC1);
  for (int v = 0; v < kTiltedHeight; ++v) {
    for (int u = 0; u < kTiltedWidth; ++u) {
      const Eigen::Vector3d ray = aligned_from_tilted * c.unproject(u, v, 1.0);
      const Eigen::Vector2d p = c.project(ray);
      x.at<float>(v, u) = static_cast<float>(p.x() + kTiltedDisparity + 50);
      y.at<float>(v, u) = static_cast<float>(p.y());
    }
  }
  cv::Mat right;
  cv::remap(texture, right, x, y, cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  cv::min(cv::max(right, 0), 255, right);
  return {rounded(texture.colRange(50, 50 + kTiltedWidth)), rounded(right)};
}

}  // namespace palpable::test
