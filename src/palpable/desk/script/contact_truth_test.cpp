#include "palpable/desk/script/contact_truth.h"

#include "tests/support/test.h"

#include <limits>

using namespace palpable;
using palpable::test::random_case;
using palpable::test::tolerance;

TEST_CASE("a vertex inside a capsule touches, as deep as it lies under the surface", "[script]") {
  const std::vector<Capsule> hand = {{{0, 0, 0}, {1, 0, 0}, 0.5, 0.5},
                                     {{5, 0, 0}, {6, 0, 0}, 1, 1}};
  Eigen::Matrix3Xd vertices(3, 3);
  vertices.col(0) << 0.5, 0, 2.0;
  vertices.col(1) << 0.5, 0.3, 0;
  vertices.col(2) << 0.5, 0, 0.45;
  const ContactTruth truth = contact_truth(hand, vertices);
  CHECK(truth.touching);
  CHECK(truth.vertex == 1);
  CHECK(std::abs(truth.depth - 0.2) <= tolerance(1e-15, "0.5 - 0.3"));
  CHECK(truth.clearance == 0.0);
}

TEST_CASE("without a touch the truth gives the distance of the hand", "[script]") {
  const std::vector<Capsule> hand = {{{0, 0, 0}, {1, 0, 0}, 0.5, 0.5}};
  Eigen::Matrix3Xd vertices(3, 1);
  vertices.col(0) << 0.5, 0, 2.0;
  const ContactTruth truth = contact_truth(hand, vertices);
  CHECK_FALSE(truth.touching);
  CHECK(truth.depth == 0.0);
  CHECK(truth.vertex == -1);
  CHECK(truth.clearance == 1.5);
}

TEST_CASE("without a hand there is no touch", "[script]") {
  const ContactTruth truth = contact_truth({}, Eigen::Matrix3Xd::Zero(3, 4));
  CHECK_FALSE(truth.touching);
  CHECK(truth.depth == 0.0);
}

TEST_CASE("skipping far capsules changes nothing", "[script]") {
  auto random = random_case(4);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<Capsule> hand;
  for (int i = 0; i < 12; ++i) {
    Capsule c;
    for (int k = 0; k < 3; ++k) {
      c.a[k] = uniform(random);
      c.b[k] = uniform(random);
    }
    c.ra = 0.05 + 0.05 * std::abs(uniform(random));
    c.rb = 0.05 + 0.15 * std::abs(uniform(random));
    hand.push_back(c);
  }
  for (int round = 0; round < 40; ++round) {
    Eigen::Matrix3Xd vertices(3, 3);
    for (int i = 0; i < 9; ++i) vertices(i % 3, i / 3) = 2.0 * uniform(random);
    double nearest = std::numeric_limits<double>::infinity();
    for (int v = 0; v < 3; ++v) nearest = std::min(nearest, signed_distance(hand, vertices.col(v)));
    const ContactTruth truth = contact_truth(hand, vertices);
    CHECK((truth.touching ? -truth.depth : truth.clearance) == nearest);
    CHECK(touches(hand, vertices) == (nearest < 0.0));
  }
}

TEST_CASE(
    "a finger moving along the normal is as deep as it has moved since its touch, even beyond its "
    "radius",
    "[script]") {
  const SurfacePoints box =
      sample_surface(box_surface({-0.05, -0.05, -0.05}, {0.05, 0.05, 0.0}), 0.001);
  for (const double depth : {0.001, 0.005, 0.012}) {
    INFO("depth " << depth);
    const std::vector<Capsule> finger = {{{0, 0, 0.007 - depth}, {0, 0, 0.06}, 0.007, 0.009}};
    const PressTruth truth = press_truth(finger, box);
    REQUIRE(truth.touching);
    CHECK(std::abs(truth.depth - depth) <= tolerance(2e-5, "points of the surface 1 mm apart"));
    CHECK(box.points.col(truth.point).head<2>().norm() < 0.001);
  }
  const std::vector<Capsule> above = {{{0, 0, 0.0071}, {0, 0, 0.06}, 0.007, 0.009}};
  CHECK_FALSE(press_truth(above, box).touching);
  CHECK_FALSE(press_truth({}, box).touching);
}
