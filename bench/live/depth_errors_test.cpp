#include "bench/live/depth_errors.h"

#include "tests/support/test.h"

#include <cmath>
#include <numbers>
#include <vector>

namespace palpable::app {
namespace {

using Eigen::Vector3d;

constexpr PinholeCamera kCamera{64, 48, 300, 300, 31.3, 24.6};

// A ball at 0.5 m, as a perfect depth camera sees it.
const std::vector<Capsule> kBall{{{0.002, -0.001, 0.5}, {0.002, -0.001, 0.5}, 0.02, 0.02}};

TrueView view_of(const std::vector<Capsule>& things) {
  TrueView view{DepthImage(kCamera.width, kCamera.height),
                MaskImage(kCamera.width, kCamera.height)};
  for (int y = 0; y < kCamera.height; ++y) {
    for (int x = 0; x < kCamera.width; ++x) {
      const Vector3d ray = kCamera.unproject(x, y, 1).normalized();
      const double along = ray_distance(things, Vector3d::Zero(), ray, 2);
      view.depth(x, y) = std::isfinite(along) ? static_cast<float>(along * ray.z()) : 1;
      view.shows(x, y) = std::isfinite(along) ? kShowsPresser : kShowsRoom;
    }
  }
  return view;
}

TEST_CASE("errors are measured less true, where both show a thing", "[bench][seen_object]") {
  const TrueView truth = view_of(kBall);
  DepthImage measured = truth.depth;
  for (float& z : measured) z += 0.003f;
  MaskImage shows = truth.shows;
  shows(31, 24) = kShowsRoom;  // the mask misses it
  measured(33, 24) = 0.9f;     // the room was measured there
  measured(34, 24) = std::numeric_limits<float>::quiet_NaN();
  const DepthImage errors = errors_of(measured, shows, truth), means = averaged(errors);
  int known = 0;
  for (int y = 0; y < kCamera.height; ++y) {
    for (int x = 0; x < kCamera.width; ++x) {
      const bool left_out = y == 24 && (x == 31 || x == 33 || x == 34);
      const bool is_known = truth.shows(x, y) == kShowsPresser && !left_out;
      known += is_known;
      CHECK(std::isnan(errors(x, y)) == !is_known);
      CHECK(std::isnan(means(x, y)) == !is_known);
      if (!is_known) continue;
      CHECK(errors(x, y) == Approx(0.003).margin(1e-6));
      CHECK(means(x, y) == Approx(0.003).margin(1e-6));
    }
  }
  CHECK(known > 300);
  CHECK(median_error(errors) == Approx(0.003).margin(1e-6));
  CHECK(median_error(DepthImage()) == 0);
}

TEST_CASE("means are over 15 x 15 pixels", "[bench][seen_object]") {
  DepthImage errors(40, 30);
  for (float& error : errors) error = 0;
  errors(20, 15) = 0.225f;
  const DepthImage means = averaged(errors);
  CHECK(means(20 - kAverage, 15 + kAverage) == Approx(0.225 / 225));
  CHECK(means(20 - kAverage - 1, 15) == 0);
  CHECK(means(20, 15) == Approx(0.225 / 225));
  // At a corner the window has 8 x 8 pixels.
  errors(0, 0) = 0.064f;
  CHECK(averaged(errors)(0, 0) == Approx(0.064 / 64));
}

TEST_CASE("the covered shares of a ball's pixels sum up to the area of its outline",
          "[bench][seen_object]") {
  const TrueView truth = view_of(kBall);
  const Image<float> shares = covered(truth.shows, kBall, kCamera);
  double sum = 0;
  int between = 0;
  for (const float share : shares) {
    sum += static_cast<double>(share);
    between += share > 0 && share < 1;
  }
  // A ball is seen under the half angle a with sin a = r / |c|. On the image plane its outline is
  // an ellipse with half axes f tan a and, towards the middle of the picture, 1.00004 times that.
  const double f_tan = 300 * 0.02 / std::sqrt(0.5 * 0.5 - 0.02 * 0.02);
  // 80 pixels of the outline, each off by 1/16 at most, and not all to the same side: below 0.5 %
  // of 453 px^2.
  CHECK(sum == Approx(std::numbers::pi * f_tan * f_tan).epsilon(0.005));
  CHECK(between > 50);
  // Without things the mask is taken as it is.
  const Image<float> plain = covered(truth.shows, {}, kCamera);
  for (std::size_t i = 0; i < plain.size(); ++i) {
    CHECK(plain.data()[i] == (truth.shows.data()[i] == kShowsPresser ? 1.0f : 0.0f));
  }
}

}  // namespace
}  // namespace palpable::app
