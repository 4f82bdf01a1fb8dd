#include "palpable/stereo/row_watch.h"

#include "palpable/calibrate/rectification.h"
#include "palpable/depth/depth_camera.h"
#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <random>

namespace palpable {
namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 360;
constexpr double kDisparity = 24;  // px

RectifiedStereo some_stereo() { return {{kWidth, kHeight, 350, 350, 319.5, 179.5}, 0.063, 0}; }

// A wall of blobs, blurred until it can be interpolated.
cv::Mat wall(unsigned seed) {
  cv::RNG random(seed);
  cv::Mat image(kHeight, kWidth + 200, CV_32FC1);
  random.fill(image, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(image, image, cv::Size(0, 0), 1.8);
  cv::normalize(image, image, 20, 235, cv::NORM_MINMAX);
  return image;
}

ColorImage color_of(const cv::Mat& gray) {
  ColorImage image(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto v = static_cast<std::uint8_t>(std::lround(gray.at<float>(y, x)));
      image(x, y) = {v, v, v};
    }
  }
  return image;
}

// The wall's pair, the right eye turned by the inverse of `tilt`: correcting by `tilt` aligns it.
Frame tilted_pair(const EyeTilt& tilt, unsigned seed) {
  const cv::Mat texture = wall(seed);
  const PinholeCamera c = some_stereo().camera;
  const Eigen::Matrix3d aligned_from_tilted = tilt.rotation();
  cv::Mat x(kHeight, kWidth, CV_32FC1), y(kHeight, kWidth, CV_32FC1);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const Eigen::Vector3d ray = aligned_from_tilted * c.unproject(u, v, 1.0);
      const Eigen::Vector2d p = c.project(ray);
      x.at<float>(v, u) = static_cast<float>(p.x() + kDisparity + 50);
      y.at<float>(v, u) = static_cast<float>(p.y());
    }
  }
  cv::Mat right;
  cv::remap(texture, right, x, y, cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  cv::min(cv::max(right, 0), 255, right);
  Frame frame;
  frame.left = color_of(texture.colRange(50, 50 + kWidth));
  frame.right = color_of(right);
  return frame;
}

RowError measured(const Frame& frame) {
  GrayImage left, right;
  Rectification::luma(frame.left, left);
  Rectification::luma(frame.right, right);
  RowWatch watch(some_stereo().camera);
  const Disparities d(kWidth / 2, kHeight / 2,
                      static_cast<std::int16_t>(kDisparity / 2 * kDisparitySteps));
  return watch.measure(left, right, d, GrayImage(kWidth / 2, kHeight / 2, 255), 2);
}

double degrees(double d) { return d * M_PI / 180; }

TEST_CASE("pitch and roll between the eyes are read off the rows of matched points",
          "[vision][rows]") {
  for (const EyeTilt& tilt : {EyeTilt{0, 0}, EyeTilt{degrees(0.05), 0}, EyeTilt{degrees(-0.15), 0},
                              EyeTilt{degrees(0.1), degrees(0.1)}, EyeTilt{0, degrees(-0.2)}}) {
    INFO("pitch " << tilt.pitch << ", roll " << tilt.roll);
    const RowError error = measured(tilted_pair(tilt, 1));
    REQUIRE(error.points >= 20);
    // 0.05 degrees of pitch are 0.31 px.
    CHECK(std::abs(error.tilt.pitch - tilt.pitch) * 350 <=
          test::tolerance(0.12, "px; grey levels are rounded, a roll leaks into the fit"));
    CHECK(std::abs(error.tilt.roll - tilt.roll) * 320 <=
          test::tolerance(0.12, "px at the side; the regularised fit takes a little off"));
    CHECK(std::abs(error.median_px - 350 * tilt.pitch) <=
          test::tolerance(0.15, "px; roll moves the median where points lie unevenly"));
  }
}

TEST_CASE("a correction is due when an error lasts, and not before", "[vision][rows]") {
  GrayImage left, right;
  const Frame frame = tilted_pair({degrees(0.08), 0}, 2);
  const Frame straight = tilted_pair({}, 2);
  RowWatch watch(some_stereo().camera);
  const Disparities d(kWidth / 2, kHeight / 2,
                      static_cast<std::int16_t>(kDisparity / 2 * kDisparitySteps));
  const GrayImage sure(kWidth / 2, kHeight / 2, 255);
  const auto look = [&](const Frame& f) {
    Rectification::luma(f.left, left);
    Rectification::luma(f.right, right);
    watch.measure(left, right, d, sure, 2);
    return watch.correction_due();
  };
  for (int i = 0; i < 20; ++i) CHECK_FALSE(look(straight).has_value());
  std::optional<EyeTilt> due;
  int frames = 0;
  while (!due && frames < 30) {
    due = look(frame);
    ++frames;
  }
  REQUIRE(due.has_value());
  CHECK(frames >= 3 * static_cast<int>(RowWatch::kFrames) / 4);
  CHECK(frames <= static_cast<int>(RowWatch::kFrames));
  CHECK(std::abs(due->pitch - degrees(0.08)) * 350 <= test::tolerance(0.03, "px"));
  CHECK_FALSE(watch.correction_due().has_value());  // it begins anew
  // What is not sure, or not known, gives no points.
  RowWatch other(some_stereo().camera);
  CHECK(other.measure(left, right, d, GrayImage(kWidth / 2, kHeight / 2, 40), 2).points == 0);
  CHECK(std::isnan(other.last().median_px));
  const Disparities nothing(kWidth / 2, kHeight / 2, kUnknownDisparity);
  CHECK(other.measure(left, right, nothing, sure, 2).points == 0);
}

TEST_CASE("watching takes no memory after the first frame", "[vision][rows]") {
  const Frame frame = tilted_pair({degrees(0.02), 0}, 3);
  GrayImage left, right;
  Rectification::luma(frame.left, left);
  Rectification::luma(frame.right, right);
  RowWatch watch(some_stereo().camera);
  const Disparities d(kWidth / 2, kHeight / 2,
                      static_cast<std::int16_t>(kDisparity / 2 * kDisparitySteps));
  const GrayImage sure(kWidth / 2, kHeight / 2, 255);
  CHECK(test::allocations_during([&] {
          for (int i = 0; i < 10; ++i) {
            watch.measure(left, right, d, sure, 2);
            static_cast<void>(watch.correction_due());
          }
        }) == 0);
}

TEST_CASE("a camera whose eyes are turned is right again within a second",
          "[vision][rows][depth]") {
  FrameFormat format;
  format.width = kWidth;
  format.height = kHeight;
  format.already_rectified = true;
  format.rectified = some_stereo();
  auto camera = value_or_throw(DepthCamera::make(format));
  const Frame frame = tilted_pair({degrees(0.15), degrees(0.05)}, 4);  // 0.9 px
  SeenFrame seen;
  double first = 0;
  for (int i = 0; i < 30; ++i) {
    camera.see(frame, seen);
    if (i == 0) first = seen.row_error_px;
  }
  CHECK(std::abs(first - 0.92) <= test::tolerance(0.15, "px; the median of a rolled picture"));
  CHECK(std::abs(seen.row_error_px) <= test::tolerance(0.06, "px; the watch's limit"));
  CHECK(std::abs(seen.row_correction_px - 0.92) <= test::tolerance(0.1, "px"));

  DepthSettings settings;
  settings.watch_rows = false;
  auto blind = value_or_throw(DepthCamera::make(format, settings));
  for (int i = 0; i < 20; ++i) blind.see(frame, seen);
  CHECK(std::isnan(seen.row_error_px));
  CHECK(seen.row_correction_px == 0);
}

}  // namespace
}  // namespace palpable
