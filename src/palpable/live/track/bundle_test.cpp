#include "palpable/live/track/bundle.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace palpable {
namespace {

using test::random_case;
using test::tolerance;

double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

// A camera that walks by 0.3 m past a cloud of points, each seen by some of the poses.
struct Walk {
  BundleProblem truth;
  BundleProblem start;  // poses with errors up to 5 mm and 0.3 degrees, points with up to 20 mm
};

Walk some_walk(unsigned seed, double noise_px, double outliers) {
  auto random = random_case(seed);
  std::normal_distribution<double> normal(0, 1);
  Walk walk;
  BundleProblem& t = walk.truth;
  t.camera = {{1280, 720, 700, 705, 640, 360}, 0.063};
  for (int i = 0; i < 6; ++i) {
    Twist twist;
    twist << -0.06 * i, 0.01 * i, 0.02 * i, 0.01 * i, -0.02 * i, 0;
    t.camera_from_world.push_back(moved_by(twist, Rigid3::Identity()));
    t.fixed.push_back(i == 0 ? 1 : 0);
  }
  for (int j = 0; j < 120; ++j) {
    t.x_in_world.push_back(t.camera.camera.unproject(
        uniform(random, 100, 1200), uniform(random, 60, 660), uniform(random, 0.5, 3)));
    for (int i = 0; i < 6; ++i) {
      if ((i + j) % 5 == 0) continue;
      BundleSighting s{i, j, {}};
      const Eigen::Vector3d noise(normal(random), normal(random), normal(random));
      s.seen.uvd = t.camera.see(t.camera_from_world[i] * t.x_in_world.back()) + noise_px * noise;
      if (uniform(random, 0, 1) < outliers) s.seen.uvd.head<2>().array() += 12;
      if ((i + j) % 3 == 0) s.seen.uvd.z() = std::numeric_limits<double>::quiet_NaN();
      s.seen.sigma = s.seen.sigma_d = 0.3;
      t.sightings.push_back(s);
    }
  }
  walk.start = t;
  for (std::size_t i = 1; i < t.camera_from_world.size(); ++i) {
    Twist wrong;
    for (int k = 0; k < 6; ++k) wrong(k) = uniform(random, -5e-3, 5e-3);
    walk.start.camera_from_world[i] = moved_by(wrong, t.camera_from_world[i]);
  }
  for (Eigen::Vector3d& x : walk.start.x_in_world) {
    x += Eigen::Vector3d(uniform(random, -0.02, 0.02), uniform(random, -0.02, 0.02),
                         uniform(random, -0.02, 0.02));
  }
  return walk;
}

double worst_position(const BundleProblem& a, const BundleProblem& b) {
  double worst = 0;
  for (std::size_t i = 0; i < a.camera_from_world.size(); ++i) {
    worst = std::max(worst, (a.camera_from_world[i].inverse().translation() -
                             b.camera_from_world[i].inverse().translation())
                                .norm());
  }
  return worst;
}

TEST_CASE("exact sightings bring poses and points back exactly", "[track]") {
  for (unsigned seed = 0; seed < 5; ++seed) {
    INFO("seed " << seed);
    Walk walk = some_walk(seed, 0, 0);
    const BundleResult result = adjust_bundle(walk.start, {.steps = 40, .converged = 1e-12});
    CHECK(result.first_cost > 1000);
    CHECK(result.last_cost <= tolerance(1e-9, "squares of 1e-6 px"));
    CHECK(worst_position(walk.start, walk.truth) <= tolerance(1e-8, "1e-6 px at 3 m and 700 px"));
    for (std::size_t j = 0; j < walk.truth.x_in_world.size(); ++j) {
      CHECK((walk.start.x_in_world[j] - walk.truth.x_in_world[j]).norm() <=
            tolerance(1e-7, "1e-6 px at 3 m and a base of 63 mm"));
    }
  }
}

TEST_CASE(
    "noise of a third of a pixel leaves poses within a millimetre, one wrong sighting in ten "
    "too",
    "[track]") {
  for (unsigned seed = 0; seed < 5; ++seed) {
    for (const double outliers : {0.0, 0.1}) {
      INFO("seed " << seed << ", outliers " << outliers);
      Walk walk = some_walk(seed, 0.3, outliers);
      const double before = worst_position(walk.start, walk.truth);
      adjust_bundle(walk.start);
      CHECK(worst_position(walk.start, walk.truth) <=
            tolerance(1.2e-3,
                      "0.3 px / sqrt(100 points) at 1.5 m and 700 px, thrice, and Cauchy's loss"));
      CHECK(before > 3e-3);
    }
  }
}

TEST_CASE("each accepted step lowers the cost, and fixed poses stay to the bit", "[track]") {
  Walk walk = some_walk(7, 0.3, 0.05);
  walk.start.fixed[3] = 1;
  const Rigid3 first = walk.start.camera_from_world[0];
  const Rigid3 fourth = walk.start.camera_from_world[3];
  double cost = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 4; ++i) {
    const BundleResult result = adjust_bundle(walk.start, {.steps = 1});
    CHECK(result.last_cost <= result.first_cost);
    CHECK(result.first_cost <= cost);
    cost = result.last_cost;
  }
  CHECK(walk.start.camera_from_world[0].matrix() == first.matrix());
  CHECK(walk.start.camera_from_world[3].matrix() == fourth.matrix());
}

TEST_CASE("the depth of a point that is seen once without disparity stays as it is", "[track]") {
  Walk walk = some_walk(8, 0.1, 0);
  const Eigen::Vector3d x(0.1, 0.1, 1);
  walk.start.x_in_world.push_back(x);
  BundleSighting s{2, static_cast<int>(walk.start.x_in_world.size()) - 1, {}};
  s.seen.uvd = walk.start.camera.see(walk.start.camera_from_world[2] * x);
  s.seen.uvd.z() = std::numeric_limits<double>::quiet_NaN();
  walk.start.sightings.push_back(s);
  adjust_bundle(walk.start);
  // It follows its pose across the line of sight; along it nothing is measured.
  CHECK((walk.start.x_in_world.back() - x).norm() <=
        tolerance(0.02, "the pose was wrong by 5 mm and 5 mrad"));
}

TEST_CASE("an error of all disparities is measured, where the camera has moved", "[track]") {
  for (const double error : {-0.8, 0.0, 0.5}) {
    INFO(error << " px");
    Walk walk = some_walk(3, 0.1, 0);
    for (BundleSighting& s : walk.start.sightings) s.seen.uvd.z() += error;
    const BundleResult result =
        adjust_bundle(walk.start, {.steps = 40, .measure_disparity_error = true});
    REQUIRE(result.disparity_information > 0);
    const double sigma = 1 / std::sqrt(result.disparity_information);
    CHECK(std::abs(result.disparity_error_px - error) <=
          tolerance(3, "sigma, of sightings whose noise is a third of their sigma") * sigma);
    CHECK(sigma <= tolerance(0.25, "px, so that 0.8 px are more than noise"));
    // Assumed from the start, it is not found once more.
    walk.start.camera.disparity_error_px = result.disparity_error_px;
    const BundleResult again =
        adjust_bundle(walk.start, {.steps = 40, .measure_disparity_error = true});
    CHECK(std::abs(again.disparity_error_px - result.disparity_error_px) <=
          tolerance(0.05, "px; the first estimate was one linear step"));
  }
}

TEST_CASE("a camera that has not moved says nothing about its disparities", "[track]") {
  Walk walk = some_walk(4, 0.1, 0);
  BundleProblem& p = walk.start;
  p.camera_from_world.resize(1);
  p.fixed.resize(1);
  std::erase_if(p.sightings, [](const BundleSighting& s) { return s.pose != 0; });
  const BundleResult result = adjust_bundle(p, {.measure_disparity_error = true});
  CHECK(result.disparity_information <= tolerance(1e-5, "1/px^2, by the weak prior of the points"));
  CHECK(adjust_bundle(p).disparity_information == 0);  // not asked for
}

TEST_CASE("sightings of nothing, or out of order, are refused", "[track]") {
  Walk walk = some_walk(9, 0, 0);
  std::swap(walk.start.sightings.front(), walk.start.sightings.back());
  CHECK_THROWS_AS(adjust_bundle(walk.start), ContractViolation);
  walk = some_walk(9, 0, 0);
  walk.start.sightings.back().pose = 6;
  CHECK_THROWS_AS(adjust_bundle(walk.start), ContractViolation);
}

}  // namespace
}  // namespace palpable
