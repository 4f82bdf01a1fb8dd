#include "palpable/contact/paper_contact.h"

#include "palpable/base/contract.h"
#include "palpable/contact/press_law.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/test.h"

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

TEST_CASE("Algorithm 1 takes the press along when another node becomes the nearest",
          "[contact][Alg1]") {
  const PaperState jumped = after({3, 4, Vector3d::Zero()}, seen(1, 0.003));
  CHECK(jumped.site == 1);
  CHECK(jumped.step == 5);
}

TEST_CASE("the nearest node is the one with the smallest distance from point to point",
          "[contact][Alg1]") {
  Eigen::Matrix3Xf nodes(3, 2);
  nodes << 0, 1, 0, 0, 0, 0;
  const std::vector<SeenPoint> cloud{{{5, 5, 5}, {0, 0, 1}, {5, 5, 5}, 1},
                                     {{0.9f, 0, 0.2f}, {0, 0, 1}, {0, 0, 0}, 1}};
  const auto nearest = nearest_node(nodes, cloud);
  REQUIRE(nearest.has_value());
  CHECK(nearest->site == 1);
  CHECK(nearest->distance == Approx(std::sqrt(0.05)).epsilon(test::tolerance(1e-6, "floats")));
  CHECK(nearest->point.z() == Approx(0.2));
  CHECK_FALSE(nearest_node(nodes, {}).has_value());
}

TEST_CASE("the nodes that are queried have the shape that the press gives them",
          "[contact][Alg1]") {
  const test::DentedSphere sphere;
  const ReducedBody body = sphere.body();
  Eigen::Matrix3Xf nodes;
  const PaperState state{1, 7, Vector3d::Zero()};
  deformed_nodes(state, body, nodes);
  REQUIRE(nodes.cols() == 5);
  for (int s = 0; s < 5; ++s) {
    const Vector3d X = body.surface.vertices.col(body.sites[s].vertex);
    const double moved = (nodes.col(s).cast<double>() - X).norm();
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
