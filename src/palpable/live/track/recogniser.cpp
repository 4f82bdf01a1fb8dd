#include "palpable/live/track/recogniser.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace palpable {
namespace {

constexpr int kFeatures = 500;
constexpr int kThumbnailWidth = 40, kThumbnailHeight = 22;  // px
constexpr int kFarthestMatch = 64;  // largest Hamming distance of a match, bits of 256
// Lowe's ratio: largest ratio of the best match's distance to that of the second best. Above it the
// best match may be a coincidence.
constexpr double kRatio = 0.85;
constexpr int kLeastFeaturesAgreeing = 12;
constexpr int kRansacTrials = 200;
constexpr float kRansacPx = 2.5F;  // largest reprojection error of a feature that agrees

cv::Mat gray(const GrayImage& image) {
  // OpenCV has no read-only matrix; this one is not written to.
  return {image.height(), image.width(), CV_8UC1,
          const_cast<std::uint8_t*>(image.data())};  // NOLINT
}

cv::Mat descriptors_of(const Features& features) {
  return {static_cast<int>(features.uv.size()), Features::kBytes, CV_8UC1,
          const_cast<std::uint8_t*>(features.descriptors.data())};  // NOLINT
}

}  // namespace

Thumbnail thumbnail_of(const GrayImage& image) {
  cv::Mat small;
  try {
    cv::resize(gray(image), small, cv::Size(kThumbnailWidth, kThumbnailHeight), 0, 0,
               cv::INTER_AREA);
    cv::GaussianBlur(small, small, cv::Size(), 1.2);
  } catch (const cv::Exception&) {  // out of memory
    return {};
  }
  Thumbnail result(small.begin<std::uint8_t>(), small.end<std::uint8_t>());
  float mean = 0, squares = 0;
  for (const float value : result) mean += value;
  mean /= static_cast<float>(result.size());
  for (float& value : result) {
    value -= mean;
    squares += value * value;
  }
  const float scale = squares > 0 ? 1 / std::sqrt(squares) : 0.0F;
  for (float& value : result) value *= scale;
  return result;
}

double likeness(const Thumbnail& a, const Thumbnail& b) {
  double sum = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    sum += static_cast<double>(a[i] * b[i]);
  }
  return sum;
}

Features find_features(const GrayImage& image, const PinholeCamera& camera,
                       const DepthImage& depth) {
  Features result;
  try {
    const cv::Ptr<cv::ORB> orb =
        cv::ORB::create(kFeatures, 1.3F, 4, 20, 0, 2, cv::ORB::HARRIS_SCORE, 24, 12);
    std::vector<cv::KeyPoint> points;
    cv::Mat descriptors;
    orb->detectAndCompute(gray(image), cv::noArray(), points, descriptors);
    if (points.empty()) return result;
    result.descriptors.assign(descriptors.data,
                              descriptors.data + descriptors.total() * descriptors.elemSize());
    const double sx = static_cast<double>(depth.width()) / image.width();
    const double sy = static_cast<double>(depth.height()) / image.height();
    for (const cv::KeyPoint& point : points) {
      result.uv.emplace_back(point.pt.x, point.pt.y);
      const auto u = static_cast<double>(point.pt.x), v = static_cast<double>(point.pt.y);
      const int x = std::clamp(static_cast<int>((u + 0.5) * sx), 0, depth.width() - 1);
      const int y = std::clamp(static_cast<int>((v + 0.5) * sy), 0, depth.height() - 1);
      const auto Z = static_cast<double>(depth(x, y));
      result.x_in_camera.push_back(camera.unproject(u, v, Z).cast<float>());  // NaN stays NaN
    }
  } catch (const cv::Exception&) { return {}; }
  return result;
}

std::optional<Recognised> recognise(const Features& now, const Features& known,
                                    const PinholeCamera& camera) {
  if (now.uv.size() < kLeastFeaturesAgreeing || known.uv.size() < kLeastFeaturesAgreeing)
    return std::nullopt;
  try {
    std::vector<std::vector<cv::DMatch>> matches;
    cv::BFMatcher(cv::NORM_HAMMING)
        .knnMatch(descriptors_of(now), descriptors_of(known), matches, 2);
    std::vector<cv::Point3f> objects;
    std::vector<cv::Point2f> pixels;
    for (const auto& pair : matches) {
      if (pair.size() < 2 || pair[0].distance > kFarthestMatch) continue;
      if (static_cast<double>(pair[0].distance) > kRatio * static_cast<double>(pair[1].distance)) {
        continue;
      }
      const Eigen::Vector3f& x = known.x_in_camera[pair[0].trainIdx];
      if (std::isnan(x.z())) continue;
      const Eigen::Vector2f& p = now.uv[pair[0].queryIdx];
      objects.emplace_back(x.x(), x.y(), x.z());
      pixels.emplace_back(p.x(), p.y());
    }
    if (static_cast<int>(objects.size()) < kLeastFeaturesAgreeing) return std::nullopt;
    const cv::Matx33d K(camera.fx_px, 0, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1);
    cv::Mat rvec, tvec, R;
    std::vector<int> agreeing;
    if (!cv::solvePnPRansac(objects, pixels, K, cv::noArray(), rvec, tvec, false, kRansacTrials,
                            kRansacPx, 0.999, agreeing, cv::SOLVEPNP_AP3P) ||
        static_cast<int>(agreeing.size()) < kLeastFeaturesAgreeing) {
      return std::nullopt;
    }
    cv::Rodrigues(rvec, R);
    Rigid3 pose = Rigid3::Identity();
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) pose.linear()(r, c) = R.at<double>(r, c);
      pose.translation()(r) = tvec.at<double>(r);
    }
    if (!pose.matrix().allFinite()) return std::nullopt;
    return Recognised{pose, static_cast<int>(agreeing.size())};
  } catch (const cv::Exception&) { return std::nullopt; }
}

}  // namespace palpable
