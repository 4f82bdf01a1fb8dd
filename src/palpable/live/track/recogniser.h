/// @file
/// From where was this picture taken? It is compared with pictures whose places are known: of
/// keyframes, when the camera is lost or may have come back to known ground.
///
/// ORB features (Rublee et al., ICCV 2011) are matched by Hamming distance and Lowe's ratio; RANSAC
/// finds the pose from three of them at a time (Ke and Roumeliotis, CVPR 2017). Comparing two
/// pictures takes milliseconds, so those that are most alike as thumbnails of 40 pixels' width (as
/// Klein and Murray, ECCV 2008) are compared first.
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
  static constexpr int kBytes = 32;          ///< of a descriptor
  std::vector<std::uint8_t> descriptors;     ///< (n x 32)
  std::vector<Eigen::Vector2f> uv;           ///< (n) px of the image they were found in
  std::vector<Eigen::Vector3f> x_in_camera;  ///< (n) m; NaN where the depth is not known
};

/// A tiny, blurred image, scaled to mean 0 and length 1; empty when OpenCV fails.
using Thumbnail = std::vector<float>;
[[nodiscard]] Thumbnail thumbnail_of(const GrayImage& image);
/// Normalised cross correlation, -1..1; 0 for an empty one.
[[nodiscard]] double likeness(const Thumbnail& a, const Thumbnail& b);

/// @param camera  of `image`
/// @param depth   m, of the same view, of any size
/// @return no features when the image shows nothing, or OpenCV fails
[[nodiscard]] Features find_features(const GrayImage& image, const PinholeCamera& camera,
                                     const DepthImage& depth);

struct Recognised {
  Rigid3 camera_from_old = Rigid3::Identity();
  int agreeing = 0;  ///< features that agree with it
};

/// The pose of the old camera, which has seen `known`, in the present one, which sees `now`;
/// nothing when fewer than 12 features agree.
[[nodiscard]] std::optional<Recognised> recognise(const Features& now, const Features& known,
                                                  const PinholeCamera& camera);

}  // namespace palpable
