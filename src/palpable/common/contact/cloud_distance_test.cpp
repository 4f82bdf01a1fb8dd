#include "palpable/common/contact/cloud_distance.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/geometry/capsule.h"
#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace palpable {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kReach = 0.025;  // m
constexpr double kVoxel = 0.004;
constexpr int kQueries = 600;  // of each cloud
constexpr float kAll = std::numeric_limits<float>::infinity();

const AlignedBox3d kRegion(Vector3d(-0.06, -0.05, 0), Vector3d(0.06, 0.05, 0.13));

using Cloud = std::vector<Vector3f>;

std::optional<NearestSeen> by_brute_force(const Cloud& cloud, const Vector3f& x, float below) {
  std::optional<NearestSeen> nearest;
  for (std::size_t k = 0; k < cloud.size(); ++k) {
    const float squared = (x - cloud[k]).squaredNorm();
    if (squared < below) nearest = {static_cast<int>(k), cloud[k], below = squared};
  }
  return nearest;
}

Vector3d some_place(std::mt19937& random, const AlignedBox3d& box) {
  std::uniform_real_distribution<double> share;
  const Vector3d t(share(random), share(random), share(random));
  return box.min() + t.cwiseProduct(box.sizes());
}

// The points of a solid that a camera above sees: rays `apart` (m) on the desk, with noise in depth
// (m).
Cloud seen_from_above(const std::vector<Capsule>& solid, double apart, double noise,
                      std::mt19937& random) {
  std::normal_distribution<double> off;
  Cloud cloud;
  const Vector3d eye(0.05, -0.15, 0.45);
  for (double x = -0.12; x < 0.12; x += apart) {
    for (double y = -0.12; y < 0.12; y += apart) {
      const Vector3d ray = (Vector3d(x, y, 0.06) - eye).normalized();
      const double t = ray_distance(solid, eye, ray, 1);
      if (std::isfinite(t))
        cloud.emplace_back((eye + (t + noise * off(random)) * ray).cast<float>());
    }
  }
  return cloud;
}

// A height field of some waves.
Cloud wavy_surface(double apart, std::mt19937& random) {
  std::uniform_real_distribution<double> any(-1, 1);
  const double height = 0.06 + 0.04 * any(random);
  struct Wave {
    double amplitude, along_x, along_y, phase;
  };
  std::vector<Wave> waves;
  for (int k = 0; k < 4; ++k) {
    waves.push_back({0.006 * any(random), 80 * any(random), 80 * any(random), 3 * any(random)});
  }
  Cloud cloud;
  for (double x = -0.07; x < 0.07; x += apart) {
    for (double y = -0.06; y < 0.06; y += apart) {
      double z = height;
      for (const Wave& wave : waves) {
        z += wave.amplitude * std::sin(wave.along_x * x + wave.along_y * y + wave.phase);
      }
      cloud.emplace_back(Vector3d(x, y, z).cast<float>());
    }
  }
  return cloud;
}

struct NamedCloud {
  std::string name;
  Cloud points;
};

// Points 3 mm apart, as a camera's at step 2, and points closer to each other than a voxel.
std::vector<NamedCloud> some_clouds() {
  std::vector<NamedCloud> clouds;
  std::mt19937 random(11);
  for (const double apart : {0.003, 0.0015}) {
    const std::string text = " " + std::to_string(1e3 * apart) + " mm apart";
    for (int n = 0; n < 4; ++n) {
      const Vector3d middle = some_place(random, kRegion);
      clouds.push_back(
          {"sphere" + text, seen_from_above({{middle, middle, 0.03, 0.03}}, apart, 0, random)});
      const Vector3d tip = some_place(random, kRegion);
      const Vector3d knuckle = tip + Vector3d(0.02 * n, -0.05, 0.03);
      clouds.push_back({"finger" + text,
                        seen_from_above({{tip, knuckle, 0.007, 0.009},
                                         {knuckle, knuckle + Vector3d(0, -0.05, 0), 0.009, 0.01}},
                                        apart, 0.001, random)});
      clouds.push_back({"waves" + text, wavy_surface(apart, random)});
    }
  }
  return clouds;
}

TEST_CASE("the grid finds the same point as a search through all points, bit for bit",
          "[contact][distance]") {
  std::mt19937 random(7);
  int near = 0, far = 0;
  for (const NamedCloud& cloud : some_clouds()) {
    INFO(cloud.name << ", " << cloud.points.size() << " points");
    CloudGrid grid(kReach);
    grid.build(cloud.points);
    for (int n = 0; n < kQueries / 4; ++n) {
      // Positions beyond the region, too, because a body may bulge.
      const Vector3f x = (1.3 * some_place(random, kRegion)).cast<float>();
      for (const float below : {static_cast<float>(kReach * kReach), 1e-5f}) {
        const auto expected = by_brute_force(cloud.points, x, below);
        const auto found = grid.nearest(x, below);
        REQUIRE(found.has_value() == expected.has_value());
        if (!found) {
          ++far;
          continue;
        }
        ++near;
        CHECK(found->index == expected->index);
        CHECK(found->squared == expected->squared);
        CHECK(found->point == expected->point);
      }
    }
  }
  CHECK(near > 500);
  CHECK(far > 1000);
}

TEST_CASE("of equally near points the grid returns the first, also for one point or a line",
          "[contact][distance]") {
  CloudGrid grid(kReach);
  grid.build(Cloud{{0.03f, 0, 0}, {0, 0.01f, 0}, {0.01f, 0, 0}, {0, -0.01f, 0}, {0, 0.01f, 0}});
  CHECK(grid.nearest(Vector3f::Zero(), 1)->index == 1);
  // `below` itself is excluded.
  CHECK_FALSE(grid.nearest(Vector3f::Zero(), 0.01f * 0.01f).has_value());
  grid.build(Cloud{{0.03f, 0, 0}});
  CHECK(grid.nearest(Vector3f::Zero(), 1)->index == 0);
  CHECK_FALSE(grid.nearest(Vector3f::Zero(), 1e-4f).has_value());
  grid.build(Cloud{});
  CHECK_FALSE(grid.nearest(Vector3f::Zero(), 1).has_value());
  // A cloud a metre long, as another body's skin: cells become larger, not more.
  Cloud line;
  for (int k = 0; k < 5000; ++k) line.emplace_back(2e-4f * static_cast<float>(k), 0, 0);
  grid.build(line);
  for (int k = 0; k < 5000; k += 97)
    CHECK(grid.nearest(line[k] + Vector3f(0, 0.01f, 0), 1)->index == k);
}

TEST_CASE(
    "the voxmap agrees with a search through all points within half a voxel in the whole region",
    "[contact][distance][Fig8]") {
  std::mt19937 random(5);
  std::vector<double> off, near_off;
  const auto below = static_cast<float>(kReach * kReach);
  Voxmap map(kRegion, kReach, kVoxel);
  for (const NamedCloud& cloud : some_clouds()) {
    INFO(cloud.name << ", " << cloud.points.size() << " points");
    map.build(cloud.points);
    std::uniform_int_distribution<std::size_t> which(0, cloud.points.size() - 1);
    double worst = 0;
    for (int n = 0; n < kQueries; ++n) {
      // Every other position is near a point, where touches are decided.
      Vector3d x = some_place(random, kRegion);
      if (n % 2 == 1 && !cloud.points.empty()) {
        const double far = 0.008;
        const AlignedBox3d around(Vector3d::Constant(-far), Vector3d::Constant(far));
        x = cloud.points[which(random)].cast<double>() + some_place(random, around);
        if (!kRegion.contains(x)) continue;
      }
      const auto expected = by_brute_force(cloud.points, x.cast<float>(), kAll);
      const auto found = map.nearest(x.cast<float>(), below);
      if (!expected || expected->squared >= below) {
        CHECK_FALSE(found.has_value());
        continue;
      }
      const double true_one = std::sqrt(static_cast<double>(expected->squared));
      if (!found) {  // a distance just within the reach may be overestimated
        REQUIRE(true_one > kReach - kVoxel / 2);
        continue;
      }
      CHECK(found->point == cloud.points[found->index]);
      CHECK(found->squared == (x.cast<float>() - found->point).squaredNorm());
      off.push_back(std::sqrt(static_cast<double>(found->squared)) - true_one);
      if (true_one < kVoxel) near_off.push_back(off.back());
      worst = std::max(worst, off.back());
    }
    CHECK(worst <= test::tolerance(0.5 * kVoxel, "the stated bound"));
  }
  REQUIRE(off.size() > 8 * kQueries);
  REQUIRE(near_off.size() > kQueries);
  std::sort(off.begin(), off.end());
  const double most = off.back(), usual = off[off.size() * 99 / 100];
  UNSCOPED_INFO("of a voxel: largest " << most / kVoxel << ", 99 % " << usual / kVoxel << " of "
                                       << off.size() << " queries");
  CHECK(off.front() >= 0);  // a point of the cloud is never nearer than the nearest
  CHECK(usual < 0.25 * kVoxel);
  // Below the side of a voxel the points themselves are searched.
  CHECK(*std::max_element(near_off.begin(), near_off.end()) == 0);
}

TEST_CASE(
    "a field that is built again has no points of the frame before, and an empty one has none",
    "[contact][distance]") {
  Voxmap map(kRegion, kReach, kVoxel);
  const Vector3f left(-0.04f, 0, 0.05f), right(0.04f, 0, 0.05f);
  map.build(Cloud{left, left + Vector3f(0, 0.01f, 0)});
  CHECK(map.nearest(left, 1)->index == 0);
  map.build(Cloud{right});
  CHECK_FALSE(map.nearest(left, static_cast<float>(kReach * kReach)).has_value());
  CHECK(map.nearest(right, 1)->index == 0);
  // Points beyond the reach of the region are left out.
  map.build(Cloud{Vector3f(0.5f, 0, 0), right});
  CHECK(map.nearest(right, 1)->index == 1);
  map.build(Cloud{Vector3f(0.5f, 0, 0)});
  CHECK_FALSE(map.nearest(right, 1).has_value());
  map.build(Cloud{});
  CHECK_FALSE(map.nearest(right, 1).has_value());
}

TEST_CASE("the voxels of a large region are larger, so that there are 4 million at most",
          "[contact][distance]") {
  CHECK(Voxmap(kRegion, kReach, kVoxel).voxel() == Approx(kVoxel).epsilon(1e-6));
  const AlignedBox3d large(Vector3d::Zero(), Vector3d(2, 1, 1));
  const double voxel = Voxmap(large, kReach, kVoxel).voxel();
  CHECK(voxel > kVoxel);
  CHECK(large.volume() / (voxel * voxel * voxel) < 4e6);
  CHECK(large.volume() / (voxel * voxel * voxel) > 2e6);
}

TEST_CASE("both queries take no memory once there is room, and give the same bytes again",
          "[contact][distance]") {
  const std::vector<NamedCloud> clouds = some_clouds();
  std::size_t most = 0;
  for (const NamedCloud& cloud : clouds) most = std::max(most, cloud.points.size());
  for (const DistanceQuery how : {DistanceQuery::kGrid, DistanceQuery::kVoxmap}) {
    CloudDistance one(how, kRegion, kReach, kVoxel), fresh(how, kRegion, kReach, kVoxel);
    one.reserve(most);
    int found = 0;
    CHECK(test::allocations_during([&] {
            for (const NamedCloud& cloud : clouds) {
              one.build(cloud.points);
              found += one.nearest(kRegion.center().cast<float>(), 1).has_value();
            }
          }) == 0);
    CHECK(found > 0);
    fresh.build(clouds.back().points);
    std::mt19937 random(2);
    for (int n = 0; n < 500; ++n) {
      const Vector3f x = some_place(random, kRegion).cast<float>();
      const auto a = one.nearest(x, 1), b = fresh.nearest(x, 1);
      REQUIRE(a.has_value() == b.has_value());
      if (a) CHECK((a->index == b->index && a->squared == b->squared));
    }
  }
}

TEST_CASE("a query without a reach, a region or a voxel is refused", "[contact][errors]") {
  CHECK_THROWS_AS(CloudGrid(0), ContractViolation);
  CHECK_THROWS_AS(CloudGrid(std::nan("")), ContractViolation);
  CHECK_THROWS_AS(Voxmap(kRegion, 0, kVoxel), ContractViolation);
  CHECK_THROWS_AS(Voxmap(kRegion, kReach, 0), ContractViolation);
  CHECK_THROWS_AS(Voxmap(kRegion, kReach, std::nan("")), ContractViolation);
  CHECK_THROWS_AS(Voxmap(AlignedBox3d(), kReach, kVoxel), ContractViolation);
}

}  // namespace
}  // namespace palpable
