/// @file
/// Finds the pose from which a picture was taken by comparing it with pictures of known pose. These
/// are keyframes, and the comparison is made when the camera is lost or may have returned to a
/// known part of the scene.
///
/// ORB features (Rublee et al., ICCV 2011) are matched by Hamming distance and Lowe's ratio; RANSAC
/// finds the pose from three of them at a time (Ke and Roumeliotis, CVPR 2017). Comparing two
/// pictures takes milliseconds, so those that are most similar as thumbnails of 40 pixels' width
/// (as in Klein and Murray, ECCV 2008) are compared first.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace palpable {

/// The features of one image. Plain data; 20 kB.
struct Features {
  static constexpr int kBytes = 32;          ///< size of a descriptor, bytes
  std::vector<std::uint8_t> descriptors;     ///< (n x 32)
  std::vector<Eigen::Vector2f> uv;           ///< (n) px of the image in which they were found
  std::vector<Eigen::Vector3f> x_in_camera;  ///< (n) m; NaN where the depth is not known
};

/// A tiny, blurred image, scaled to mean 0 and length 1; empty if OpenCV fails.
using Thumbnail = std::vector<float>;
[[nodiscard]] Thumbnail thumbnail_of(const GrayImage& image);
/// Normalised cross correlation, -1..1; 0 if one is empty.
[[nodiscard]] double likeness(const Thumbnail& a, const Thumbnail& b);

/// @param camera  of `image`
/// @param depth   m, of the same view, of any size
/// @return no features if the image has no texture, or if OpenCV fails
[[nodiscard]] Features find_features(const GrayImage& image, const PinholeCamera& camera,
                                     const DepthImage& depth);

struct Recognised {
  Rigid3 camera_from_old = Rigid3::Identity();
  int agreeing = 0;  ///< features that agree with it
};

/// The relative pose of the present camera, which sees `now`, and the old camera, which has seen
/// `known`. Nothing if fewer than 12 features agree.
[[nodiscard]] std::optional<Recognised> recognise(const Features& now, const Features& known,
                                                  const PinholeCamera& camera);

}  // namespace palpable
