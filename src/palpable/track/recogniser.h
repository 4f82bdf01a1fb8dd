/// @file
/// Where has this been seen before? Features of keyframes with their places, looked up when the
/// camera is lost.
///
/// ORB features (Rublee et al., ICCV 2011), matched by Hamming distance and Lowe's ratio; the pose
/// from three of them (Ke and Roumeliotis, CVPR 2017) by RANSAC. Which keyframes are asked first is
/// told by images of 40 pixels' width (as Klein and Murray, ECCV 2008).
#pragma once

#include "palpable/geometry/camera.h"
#include "palpable/geometry/image.h"
#include "palpable/geometry/rigid.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace palpable {

/// What is kept of an image. Plain data; 20 kB.
struct Features {
  static constexpr int kBytes = 32;          // of a descriptor
  std::vector<std::uint8_t> descriptors;     ///< (n x 32)
  std::vector<Eigen::Vector2f> uv;           ///< (n) px of the image they were found in
  std::vector<Eigen::Vector3f> x_in_camera;  ///< (n) m; NaN where the depth is not known
};

/// A tiny image, mean 0 and length 1.
using Thumbnail = std::vector<float>;
[[nodiscard]] Thumbnail thumbnail_of(const GrayImage& image);
[[nodiscard]] double likeness(const Thumbnail& a, const Thumbnail& b);

/// @param camera  of `image`
/// @param depth   of the same view, of any size
/// Empty when the image holds nothing, or OpenCV fails.
[[nodiscard]] Features find_features(const GrayImage& image, const PinholeCamera& camera,
                                     const DepthImage& depth);

struct Recognised {
  Rigid3 camera_from_old = Rigid3::Identity();
  int agreeing = 0;  ///< features
};

/// Where the camera in which `known` was seen stands in the present one; nothing when too few
/// features agree on it.
[[nodiscard]] std::optional<Recognised> recognise(const Features& now, const Features& known,
                                                  const PinholeCamera& camera);

}  // namespace palpable
