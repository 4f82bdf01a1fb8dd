#include "bench/live/opencv_odometry.h"

#include "palpable/live/track/sighting.h"

#include <Eigen/Geometry>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/rgbd/depth.hpp>

#include <cstdint>
#include <vector>

namespace palpable::app {
namespace {

// A camera that moves or turns by more than this gets a new keyframe: ratio to the largest depth
// used, and rad. Error of OpenCV's path through the kitchen of 400 frames: 42 mm with these values,
// 48 mm with half of both, 72 mm with twice both.
constexpr double kFarFromKeyframe = 0.05;
constexpr double kTurnedFromKeyframe = 0.2;

cv::Ptr<cv::rgbd::RgbdOdometry> odometry_of(const PinholeCamera& camera, double farthest) {
  const cv::Matx33f K(static_cast<float>(camera.fx_px), 0, static_cast<float>(camera.cx_px), 0,
                      static_cast<float>(camera.fy_px), static_cast<float>(camera.cy_px), 0, 0, 1);
  // Depths of one point in two frames that differ by more than this are of two surfaces: OpenCV's
  // default is 0.07 m for depths up to 4 m.
  const double difference = 0.07 / 4 * farthest;
  return cv::rgbd::RgbdOdometry::create(cv::Mat(K), 0, static_cast<float>(farthest),
                                        static_cast<float>(difference));
}

// Makes the rotation orthonormal to the last digit, because the loop multiplies hundreds of them.
Rigid3 rigid_of(const cv::Mat& Rt) {
  Rigid3 pose = Rigid3::Identity();
  for (int k = 0; k < 12; ++k) pose.matrix()(k / 4, k % 4) = Rt.at<double>(k / 4, k % 4);
  return moved_by(Twist::Zero(), pose);
}

cv::Mat matrix_of(const Rigid3& pose) {
  cv::Mat Rt = cv::Mat::eye(4, 4, CV_64F);
  for (int k = 0; k < 12; ++k) Rt.at<double>(k / 4, k % 4) = pose.matrix()(k / 4, k % 4);
  return Rt;
}

}  // namespace

struct OpenCvOdometry::Parts {
  double farthest;
  cv::Ptr<cv::rgbd::RgbdOdometry> odometry;
  cv::Ptr<cv::rgbd::OdometryFrame> keyframe, last;
  Rigid3 world_from_keyframe = Rigid3::Identity();
  Rigid3 world_from_last = Rigid3::Identity();
  Rigid3 last_from_now = Rigid3::Identity();  // the last motion
  int failed = 0;

  // Computes keyframe_from_camera, starting from `guess`.
  bool find(const cv::Ptr<cv::rgbd::OdometryFrame>& now, const Rigid3& guess, Rigid3& found) const {
    cv::Mat Rt;
    cv::Ptr<cv::rgbd::OdometryFrame> a = now, b = keyframe;
    if (!odometry->compute(a, b, Rt, matrix_of(guess))) return false;
    found = rigid_of(Rt);
    return true;
  }
  [[nodiscard]] bool is_far(const Rigid3& keyframe_from_camera) const {
    return keyframe_from_camera.translation().norm() > kFarFromKeyframe * farthest ||
           Eigen::AngleAxisd(keyframe_from_camera.linear()).angle() > kTurnedFromKeyframe;
  }
};

OpenCvOdometry::OpenCvOdometry(const PinholeCamera& camera, double farthest)
    : parts_(std::make_unique<Parts>()) {
  parts_->farthest = farthest;
  parts_->odometry = odometry_of(camera, farthest);
}
OpenCvOdometry::OpenCvOdometry(OpenCvOdometry&&) noexcept = default;
OpenCvOdometry::~OpenCvOdometry() = default;

int OpenCvOdometry::failed() const { return parts_->failed; }

Rigid3 OpenCvOdometry::follow(const SeenFrame& seen) {
  Parts& p = *parts_;
  const cv::Mat image(seen.left.height(), seen.left.width(), CV_8UC1,
                      const_cast<std::uint8_t*>(seen.left.data()));  // NOLINT: read only
  const cv::Mat depth(seen.depth.height(), seen.depth.width(), CV_32FC1,
                      const_cast<float*>(seen.depth.data()));  // NOLINT: read only
  cv::Mat full;
  cv::resize(depth, full, image.size(), 0, 0, cv::INTER_NEAREST);
  auto now = cv::Ptr<cv::rgbd::OdometryFrame>(
      new cv::rgbd::OdometryFrame(image.clone(), full.clone(), cv::Mat(), cv::Mat(), seen.number));
  if (p.keyframe.empty()) {
    p.keyframe = p.last = now;
    return p.world_from_last;
  }
  const Rigid3 predicted = moved_by(Twist::Zero(), p.world_from_last * p.last_from_now);
  Rigid3 keyframe_from_camera = Rigid3::Identity();
  bool found = p.find(now, p.world_from_keyframe.inverse() * predicted, keyframe_from_camera);
  if (!found || p.is_far(keyframe_from_camera)) {
    p.keyframe = p.last;
    p.world_from_keyframe = p.world_from_last;
    found = p.find(now, p.last_from_now, keyframe_from_camera);
  }
  if (!found) {
    ++p.failed;
    keyframe_from_camera = p.world_from_keyframe.inverse() * predicted;
  }
  const Rigid3 world_from_camera =
      moved_by(Twist::Zero(), p.world_from_keyframe * keyframe_from_camera);
  p.last_from_now = p.world_from_last.inverse() * world_from_camera;
  p.world_from_last = world_from_camera;
  p.last = now;
  return world_from_camera;
}

}  // namespace palpable::app
