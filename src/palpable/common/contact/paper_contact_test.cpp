#include "palpable/common/contact/paper_contact.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/contact/cloud_distance.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "tests/support/allocations.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/test.h"

#include <algorithm>
#include <random>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr PaperSettings kSettings{.press_distance = 0.004, .release_distance = 0.012};
constexpr int kLast = 5;

std::optional<NearestNode> seen(int site, double distance) {
  return NearestNode{site, distance, Vector3d(0.1, 0.2, 0.3)};
}

PaperState after(const PaperState& state, const std::optional<NearestNode>& nearest) {
  return advance_as_printed(state, nearest, kLast, kSettings);
}

TEST_CASE("nearer than delta_Incr raises the pseudo-time by one per frame up to the last",
          "[contact][Alg1]") {
  PaperState state;
  for (int frame = 1; frame <= 8; ++frame) {
    state = after(state, seen(3, 0.001));
    CHECK(state.step == std::min(frame, kLast));
    CHECK(state.site == 3);
  }
}

TEST_CASE("between delta_Incr and delta_Decr the pseudo-time falls by one per frame to 0",
          "[contact][Alg1]") {
  PaperState state{3, 2, Vector3d::Zero()};
  for (int frame = 1; frame <= 4; ++frame) {
    state = after(state, seen(3, 0.008));
    CHECK(state.step == std::max(2 - frame, 0));
  }
}

TEST_CASE("a distance of exactly a threshold changes nothing, as printed", "[contact][Alg1]") {
  const PaperState pressed{3, 2, Vector3d::Zero()};
  CHECK(after(pressed, seen(3, 0.004)) == pressed);
  CHECK(after(pressed, seen(3, 0.012)) == pressed);
}

TEST_CASE("Algorithm 1 freezes when the hand leaves between two frames", "[contact][Alg1]") {
  PaperState pressed{3, 2, Vector3d::Zero()};
  for (int frame = 0; frame < 100; ++frame) {
    pressed = after(pressed, frame % 2 == 0 ? seen(3, 1.0) : std::nullopt);
  }
  CHECK(pressed.step == 2);
}

TEST_CASE("Algorithm 1 moves the whole press to another node when that becomes the nearest",
          "[contact][Alg1]") {
  const PaperState jumped = after({3, 4, Vector3d::Zero()}, seen(1, 0.003));
  CHECK(jumped.site == 1);
  CHECK(jumped.step == 5);
}

TEST_CASE("the nearest node is the one with the smallest distance from point to point",
          "[contact][Alg1]") {
  const ReducedBody body = test::DentedSphere{}.body();
  const PaperNodes nodes(body, QueriedNodes::kSites);
  const Vector3f front = nodes.positions().col(1);  // y points backwards
  const std::vector<Vector3f> cloud{{5, 5, 5}, front + Vector3f(0.003f, -0.004f, 0)};
  const auto nearest = nearest_by_all_pairs(nodes, cloud);
  REQUIRE(nearest.has_value());
  CHECK(nearest->site == 1);
  CHECK(nearest->distance == Approx(0.005).epsilon(test::tolerance(1e-5, "floats of 5 cm")));
  CHECK(nearest->point == cloud[1].cast<double>());
  CHECK_FALSE(nearest_by_all_pairs(nodes, {}).has_value());
}

// Points of a ball of radius 12 mm that hovers 2 mm above the sphere in a direction.
std::vector<Vector3f> hovering_cap(const Vector3d& direction, std::mt19937& random) {
  const Vector3d centre = Vector3d(0, 0, 0.05) + 0.064 * direction;
  std::normal_distribution<double> any;
  std::vector<Vector3f> cloud;
  for (int k = 0; k < 400; ++k) {
    const Vector3d out = Vector3d(any(random), any(random), any(random)).normalized();
    cloud.emplace_back((centre + 0.012 * out).cast<float>());
  }
  return cloud;
}

TEST_CASE("the grid finds the same pair as all pairs, in any pressed shape", "[contact][Alg1]") {
  const ReducedBody body = test::DentedSphere{}.body();
  const double reach = 0.025;
  CloudDistance grid(DistanceQuery::kGrid, box_of(body.surface), reach, 0.004);
  std::mt19937 random(3);
  std::normal_distribution<double> any;
  int near = 0;
  for (const QueriedNodes which : {QueriedNodes::kSites, QueriedNodes::kAll}) {
    PaperNodes nodes(body, which);
    for (int n = 0; n < 60; ++n) {
      INFO("cloud " << n);
      const auto cloud =
          hovering_cap(Vector3d(any(random), any(random), any(random)).normalized(), random);
      nodes.deform({n % 5, n % 11, Vector3d::Zero()}, body);
      grid.build(cloud);
      const auto found = nearest_node(nodes, grid);
      const auto expected = nearest_by_all_pairs(nodes, cloud);
      REQUIRE(expected.has_value());
      REQUIRE(found.has_value() == (expected->distance < reach));
      if (!found) continue;
      ++near;
      CHECK(found->site == expected->site);
      CHECK(found->distance == expected->distance);
      CHECK(found->point == expected->point);
    }
  }
  CHECK(near > 60);
}

TEST_CASE("all nodes of the skin except held ones are queried, and the nearest site is pressed",
          "[contact][Alg1]") {
  const ReducedBody body = test::DentedSphere{}.body();
  PaperNodes nodes(body, QueriedNodes::kAll);
  const Eigen::Matrix3Xd& X = body.surface.vertices;
  const auto held = std::count(body.fixed.begin(), body.fixed.end(), 1);
  REQUIRE(held > 0);
  CHECK(nodes.positions().cols() == X.cols() - held);
  // A point above a node between two sites, nearer to the second of them (-y) than to the top.
  const Vector3d between = Vector3d(0, -0.8, 0.6);
  int vertex = 0;
  (X.colwise() - (Vector3d(0, 0, 0.05) + 0.05 * between)).colwise().squaredNorm().minCoeff(&vertex);
  const std::vector<Vector3f> cloud{(X.col(vertex) + 0.001 * between).cast<float>()};
  const auto nearest = nearest_by_all_pairs(nodes, cloud);
  REQUIRE(nearest.has_value());
  CHECK(nearest->site == 1);
  CHECK(nearest->distance == Approx(0.001).margin(test::tolerance(1e-7, "floats of 5 cm")));
  // The middles of the sites alone are 31 mm away.
  CHECK(nearest_by_all_pairs(PaperNodes(body, QueriedNodes::kSites), cloud)->distance > 0.02);
  // A point below the support is far from all nodes.
  const std::vector<Vector3f> below{{0, 0, -0.001f}};
  CHECK(nearest_by_all_pairs(nodes, below)->distance > 0.01);
  // The nodes have the pressed shape.
  nodes.deform({1, 7, Vector3d::Zero()}, body);
  const double deepest = nodes.positions().row(1).minCoeff();
  CHECK(deepest > -0.05 + 0.5 * test::DentedSphere{}.depth(0.7));
  nodes.deform({}, body);
  CHECK(nodes.positions().row(1).minCoeff() == Approx(-0.05).margin(1e-6));
}

TEST_CASE("a frame of Algorithm 1 allocates nothing, with any nodes and either query",
          "[contact][Alg1]") {
  const ReducedBody body = test::DentedSphere{}.body();
  std::mt19937 random(3);
  const auto cloud = hovering_cap({0, 0, 1}, random);
  for (const QueriedNodes which : {QueriedNodes::kSites, QueriedNodes::kAll}) {
    for (const DistanceQuery how : {DistanceQuery::kGrid, DistanceQuery::kVoxmap}) {
      PaperNodes nodes(body, which);
      CloudDistance seen(how, box_of(body.surface), 0.025, 0.004);
      seen.reserve(cloud.size());
      CHECK(test::allocations_during([&] {
              nodes.deform({1, 3, Vector3d::Zero()}, body);
              seen.build(cloud);
              static_cast<void>(nearest_node(nodes, seen));
            }) == 0);
    }
  }
}

TEST_CASE("the queried nodes have the pressed shape", "[contact][Alg1]") {
  const test::DentedSphere sphere;
  const ReducedBody body = sphere.body();
  PaperNodes nodes(body, QueriedNodes::kSites);
  const PaperState state{1, 7, Vector3d::Zero()};
  nodes.deform(state, body);
  REQUIRE(nodes.positions().cols() == 5);
  for (int s = 0; s < 5; ++s) {
    const Vector3d X = body.surface.vertices.col(body.sites[s].vertex);
    const double moved = (nodes.positions().col(s).cast<double>() - X).norm();
    if (s == 1) {
      CHECK(moved == Approx(sphere.depth(0.7)).epsilon(test::tolerance(1e-5, "floats")));
    } else {
      CHECK(moved < 1e-4);
    }
  }
  const auto touch = touch_of(state, body);
  REQUIRE(touch.has_value());
  CHECK(touch->level == Approx(0.7));
  CHECK(touch->force == Approx(0.7 * 3.0));
  CHECK(touch->press_depth == body.press_depth(7, 1));
  CHECK_FALSE(touch_of(PaperState{}, body).has_value());
}

TEST_CASE("thresholds that contradict each other are refused", "[contact][errors]") {
  CHECK_THROWS_AS(advance_as_printed({}, std::nullopt, kLast, {0.004, 0.004}), ContractViolation);
  CHECK_THROWS_AS(advance_as_printed({}, std::nullopt, kLast, {0, 0.004}), ContractViolation);
  CHECK_THROWS_AS(advance_as_printed({}, std::nullopt, 0, kSettings), ContractViolation);
}

}  // namespace
}  // namespace palpable
