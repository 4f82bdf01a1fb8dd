#include "palpable/live/seen_object/creases.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/live/seen_object/object_surface.h"
#include "tests/support/allocations.h"
#include "tests/support/seen_capsules.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3d;
using test::Capsule;

constexpr PinholeCamera kCamera{161, 121, 350, 350, 80, 60};
constexpr double kMostRadius = 0.0125;  // m

// A finger straight down the picture at a distance of 0.4 m.
Capsule finger(double x, double z, double radius) { return {{x, -0.2, z}, {x, 0.2, z}, radius}; }

// The depth as a matcher gives it: 1/Z averaged over 5 x 5 pixels of things, with noise added.
// @param noise  m, standard deviation
DepthImage as_matched(const DepthImage& depth, double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, noise);
  DepthImage matched(depth.width(), depth.height(), std::numeric_limits<float>::quiet_NaN());
  for (int v = 2; v + 2 < depth.height(); ++v) {
    for (int u = 2; u + 2 < depth.width(); ++u) {
      if (std::isnan(depth(u, v))) continue;
      double sum = 0, count = 0;
      for (int y = v - 2; y <= v + 2; ++y) {
        for (int x = u - 2; x <= u + 2; ++x) {
          if (std::isnan(depth(x, y))) continue;
          sum += 1 / static_cast<double>(depth(x, y)), count += 1;
        }
      }
      matched(u, v) = static_cast<float>(count / sum + normal(random));
    }
  }
  return matched;
}

Creases creases_of(const DepthImage& depth) {
  Silhouette silhouette;
  silhouette.find(depth, {}, {0, 0, depth.width(), depth.height()});
  Creases creases;
  creases.find(depth, kCamera, silhouette, kMostRadius);
  return creases;
}

TEST_CASE("two fingers side by side meet in one crease, and both end there",
          "[seen_object][creases]") {
  const DepthImage depth =
      test::depth_of({finger(-0.008, 0.4, 0.008), finger(0.008, 0.4, 0.008)}, kCamera);
  const Creases creases = creases_of(depth);
  CHECK(creases.pixels().size() > 100);
  for (const CreasePixel& pixel : creases.pixels()) {
    CHECK(std::abs(pixel.x - 80) <=
          1);  // between pixels 79 and 80, or at 80: the ray through x = 0
    CHECK(std::abs(pixel.across.x()) == Approx(1).margin(0.02));
    for (const std::optional<float>& hidden : pixel.hidden) {
      REQUIRE(hidden.has_value());
      CHECK(*hidden < 1.0f);  // px; a finger is 14 px wide. The slope is that of a plane over 4 px
    }
  }
}

TEST_CASE("a crease tells how much of the finger behind another one is hidden",
          "[seen_object][creases]") {
  // A finger 16 mm wide of which hidden_m lies behind another one, which ends at x = 0.
  for (const double hidden_m : {0.002, 0.005}) {
    INFO("hidden " << hidden_m);
    const DepthImage depth = test::depth_of(
        {finger(-0.008, 0.4, 0.008), finger(0.008 - hidden_m, 0.406, 0.008)}, kCamera);
    const Creases creases = creases_of(depth);
    REQUIRE(creases.pixels().size() > 100);
    std::vector<double> behind;
    for (const CreasePixel& pixel : creases.pixels()) {
      const std::optional<float>& hidden = pixel.hidden[pixel.across.x() > 0 ? 1 : 0];
      REQUIRE(hidden.has_value());
      behind.push_back(static_cast<double>(*hidden));
    }
    // A pixel is 0.4 m / 350 wide. The crease is located to a pixel, which enters the width twice.
    CHECK(upper_median(behind) == Approx(hidden_m * 350 / 0.4).margin(2.5));
  }
}

TEST_CASE("neither noise nor a thing that is nowhere hollow has creases",
          "[seen_object][creases]") {
  for (unsigned seed = 0; seed < 5; ++seed) {
    INFO("seed " << seed);
    // A forearm; the noise is that of one pixel of a stereo camera, 6 mm Z^2 at 1 m.
    const DepthImage depth = test::depth_of({finger(0, 0.44, 0.04)}, kCamera);
    CHECK(creases_of(as_matched(depth, 0.001, seed)).pixels().empty());
  }
  CHECK(creases_of(test::depth_of({finger(0, 0.4, 0.008)}, kCamera)).pixels().empty());
  CHECK(creases_of(DepthImage(161, 121, std::numeric_limits<float>::quiet_NaN())).pixels().empty());
}

TEST_CASE("four fingers side by side are as thick as fingers, though their valleys are blurred",
          "[seen_object][creases][object surface]") {
  const double radius = 0.008;
  std::vector<Capsule> hand;
  for (int k = 0; k < 4; ++k) {
    hand.push_back(finger((k - 1.5) * 2 * radius, 0.4 + 0.003 * k, radius));
  }
  const DepthImage seen = test::depth_of(hand, kCamera);
  for (unsigned seed = 0; seed < 3; ++seed) {
    INFO("seed " << seed);
    const DepthImage depth = as_matched(seen, 0.0003, seed);
    ObjectSurface surface;
    surface.build(depth, {}, kCamera, Rigid3::Identity(),
                  {Vector3d(-0.03, -0.02, 0.38), Vector3d(0.03, 0.02, 0.44)});
    std::vector<double> errors;
    for (const Capsule& one : hand) {
      for (int k = -3; k <= 3; ++k) {
        const double angle = k * 0.2;  // rad, round the finger from its back
        const Vector3d x = Vector3d(one.a.x() + radius * std::sin(angle), 0.0,
                                    one.a.z() + radius * std::cos(angle));
        const auto found = surface.nearest(x.cast<float>());
        REQUIRE(found.has_value());
        errors.push_back(std::abs(static_cast<double>(found->distance)));
      }
    }
    // If the hand were taken for one thing 25 mm thick, the median would be 9.7 mm.
    CHECK(upper_median(errors) < 0.002);
  }
}

TEST_CASE("finding creases again allocates nothing", "[seen_object][creases]") {
  const DepthImage depth =
      test::depth_of({finger(-0.008, 0.4, 0.008), finger(0.008, 0.4, 0.008)}, kCamera);
  Silhouette silhouette;
  silhouette.find(depth, {}, {0, 0, depth.width(), depth.height()});
  Creases creases;
  creases.find(depth, kCamera, silhouette, kMostRadius);
  CHECK(allocations_during([&] { creases.find(depth, kCamera, silhouette, kMostRadius); }) == 0);
  CHECK_THROWS_AS(creases.find(depth, kCamera, silhouette, 0.0), ContractViolation);
}

}  // namespace
}  // namespace palpable
