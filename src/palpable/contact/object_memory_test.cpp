// What is remembered of things, through the surface that they are part of.
#include "palpable/contact/object_memory.h"

#include "palpable/base/order_statistics.h"
#include "palpable/contact/object_surface.h"
#include "tests/support/allocations.h"
#include "tests/support/seen_capsules.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3d;
using test::Capsule;
using test::tolerance;

constexpr PinholeCamera kCamera{161, 121, 350, 350, 80, 60};
constexpr float kWall = 0.7f;  // m, behind everything

const Eigen::AlignedBox3d kRegion{Vector3d(-0.06, -0.06, 0.34), Vector3d(0.06, 0.06, 0.46)};

// A flat hand: five bars side by side, 100 x 80 x 16 mm, round its middle.
std::vector<Capsule> slab() {
  std::vector<Capsule> bars;
  for (int k = -3; k <= 3; ++k) bars.push_back({{-0.042, 0.011 * k, 0}, {0.042, 0.011 * k, 0}, 0.008});
  return bars;
}

std::vector<Capsule> at(const Rigid3& pose, std::vector<Capsule> things) {
  for (Capsule& thing : things) {
    thing.a = pose * thing.a;
    thing.b = pose * thing.b;
  }
  return things;
}

// 30 frames a second before a wall that does not press. The body's frame is the camera's.
struct Watch {
  explicit Watch(const ObjectSurfaceSettings& settings = {}) : surface(settings) {}

  void show(const std::vector<Capsule>& things, double noise = 0) {
    std::normal_distribution<double> normal;
    DepthImage depth = test::depth_of(things, kCamera);
    MaskImage shows(kCamera.width, kCamera.height, kShowsPresser);
    for (std::size_t i = 0; i < depth.size(); ++i) {
      if (std::isnan(depth.data()[i])) {
        depth.data()[i] = kWall;
        shows.data()[i] = kShowsRoom;
      } else {
        depth.data()[i] += static_cast<float>(noise * normal(random));
      }
    }
    build(depth, shows);
  }
  void show_unknown() {
    build(DepthImage(kCamera.width, kCamera.height, std::numeric_limits<float>::quiet_NaN()),
          MaskImage(kCamera.width, kCamera.height, kShowsUnknown));
  }
  void build(const DepthImage& depth, const MaskImage& shows) {
    surface.build(depth, shows, kCamera, Rigid3::Identity(), kRegion, frame++ / 30.0);
  }
  [[nodiscard]] double phi(const Vector3d& x) const {
    const auto found = surface.nearest(x.cast<float>());
    return found ? static_cast<double>(found->distance) : surface.settings().band;
  }

  ObjectSurface surface;
  std::mt19937_64 random = test::random_case(1);
  int frame = 0;
};

Rigid3 turned(double angle) {
  Rigid3 pose = Rigid3::Identity();
  pose.linear() = Eigen::AngleAxisd(angle, Vector3d::UnitX()).toRotationMatrix();
  pose.translation() = Vector3d(0, 0, 0.4);
  return pose;
}

// The share of a slab's far half that is known to within 4 mm, seen along its edge.
double known_far_half(const Watch& watch, const Rigid3& pose) {
  int known = 0, asked = 0;
  for (double x = -0.03; x <= 0.03; x += 0.01) {
    for (double y = 0.002; y <= 0.03; y += 0.004) {
      for (const double side : {-0.008, 0.008}) {
        ++asked;
        known += std::abs(watch.phi(pose * Vector3d(x, y, side))) < 0.004 ? 1 : 0;
      }
    }
  }
  return static_cast<double>(known) / asked;
}

TEST_CASE("a hand that turns its edge to the camera keeps what was seen of its back",
          "[contact][memory]") {
  const double quarter = std::numbers::pi / 2;
  // Only its edge was ever seen: nobody knows how far it reaches back.
  Watch edge_alone;
  for (int n = 0; n < 3; ++n) edge_alone.show(at(turned(-quarter), slab()));
  CHECK(known_far_half(edge_alone, turned(-quarter)) < 0.3);
  // From flat to edge-on in two thirds of a second; its +Y end goes away from the camera.
  Watch turning;
  for (int n = 0; n <= 20; ++n) turning.show(at(turned(-quarter * n / 20), slab()));
  CHECK(known_far_half(turning, turned(-quarter)) > 0.9);
  // What is remembered is not measured.
  const auto far = turning.surface.nearest(Eigen::Vector3f(0, 0.008f, 0.425f));
  REQUIRE(far);
  CHECK_FALSE(far->is_measured);
}

TEST_CASE("a thing whose place is seen free has gone at once", "[contact][memory]") {
  Watch watch;
  const Capsule finger{{-0.05, 0, 0.4}, {0.05, 0, 0.4}, 0.008};
  for (int n = 0; n < 5; ++n) watch.show({finger});
  REQUIRE(watch.phi({0, 0, 0.4}) < -0.006);
  watch.show({});
  CHECK(watch.surface.balls().empty());
}

TEST_CASE("a thing that is neither seen nor seen through is held, and fades", "[contact][memory]") {
  Watch watch;
  const Capsule finger{{-0.05, 0, 0.4}, {0.05, 0, 0.4}, 0.008};
  for (int n = 0; n < 5; ++n) watch.show({finger});
  const double before = watch.phi({0, 0, 0.4});
  for (int n = 0; n < 8; ++n) watch.show_unknown();  // 0.27 s
  CHECK(watch.phi({0, 0, 0.4}) == Approx(before).margin(1e-6));
  const auto held = watch.surface.nearest(Eigen::Vector3f(0, 0, 0.393f));
  REQUIRE(held);
  CHECK_FALSE(held->is_measured);
  for (int n = 0; n < 5; ++n) watch.show_unknown();  // 0.43 s
  CHECK(watch.phi({0, 0, 0.4}) > before);
  CHECK(watch.phi({0, 0, 0.4}) < 0);
  for (int n = 0; n < 6; ++n) watch.show_unknown();  // 0.63 s
  CHECK(watch.surface.balls().empty());
}

TEST_CASE("a hand that rests gives a surface that rests", "[contact][memory]") {
  // Every pixel's depth is off by 1 mm, anew in each frame.
  const auto scatter = [](int most_frames) {
    ObjectSurfaceSettings settings;
    settings.memory.most_frames = most_frames;
    Watch watch(settings);
    const Capsule finger{{-0.05, 0.003, 0.4}, {0.05, -0.004, 0.41}, 0.008};
    std::vector<double> phi;
    for (int n = 0; n < 60; ++n) {
      watch.show({finger}, 0.001);
      if (n >= 20) phi.push_back(watch.phi({0.002, 0.006, 0.41}));
    }
    double mean = 0, square = 0;
    for (const double v : phi) mean += v / static_cast<double>(phi.size());
    for (const double v : phi) square += (v - mean) * (v - mean) / static_cast<double>(phi.size());
    return std::sqrt(square);
  };
  CHECK(scatter(12) < 0.55 * scatter(1));
}

TEST_CASE("the surface of a hand that moves at half a metre a second is where the hand is",
          "[contact][memory]") {
  // Across the view, along it, and both; 17 mm a frame. Averaged over several frames without
  // following, it would lie behind by many millimetres.
  for (const Vector3d& step : {Vector3d(0, 0.0167, 0), Vector3d(0, 0, 0.0167),
                               Vector3d(0.004, 0.012, -0.011)}) {
    INFO("step " << step.transpose());
    Watch watch;
    const Capsule finger{{-0.03, 0, 0.40}, {0.05, 0.01, 0.40}, 0.008};
    const Vector3d start = -1.5 * step;
    for (int n = 0; n < 4; ++n) {
      Rigid3 pose = Rigid3::Identity();
      pose.translation() = start + n * step;
      const std::vector<Capsule> now = at(pose, {finger});
      watch.show(now);
      std::vector<double> errors;
      for (double t = 0.2; t < 0.8; t += 0.1) {
        for (double angle = 0; angle < 6.2; angle += 0.4) {
          const Vector3d out(0, std::cos(angle), std::sin(angle));
          errors.push_back(std::abs(
              watch.phi(now[0].a + t * (now[0].b - now[0].a) + 0.008 * out)));
        }
      }
      CHECK(upper_median(errors) < tolerance(0.0007, "two thirds of a pixel"));
      CHECK(percentile(errors, 0.9) < tolerance(0.0018, "one and a half pixels"));
    }
  }
}

TEST_CASE("a hand that folds its fingers has no straight ones", "[contact][memory]") {
  Watch watch;
  const Capsule palm{{-0.03, 0, 0.4}, {-0.01, 0, 0.4}, 0.014};
  const Capsule straight{{0, 0, 0.4}, {0.05, 0, 0.4}, 0.008};
  for (int n = 0; n < 5; ++n) watch.show({palm, straight});
  REQUIRE(watch.phi({0.04, 0, 0.4}) < 0);
  watch.show({palm});
  CHECK(watch.phi({0.04, 0, 0.4}) > 0.005);
  CHECK(watch.phi({-0.02, 0, 0.4}) < -0.008);
}

TEST_CASE("remembering allocates nothing after the first frames", "[contact][frame loop]") {
  Watch watch;
  DepthImage depth = test::depth_of(at(turned(-0.3), slab()), kCamera);
  const MaskImage shows;
  const auto again = [&] { watch.build(depth, shows); };
  for (int n = 0; n < 4; ++n) again();
  CHECK(test::allocations_during(again) == 0);
  CHECK_FALSE(watch.surface.balls().empty());
}

}  // namespace
}  // namespace palpable
