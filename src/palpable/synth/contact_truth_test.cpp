#include "palpable/synth/contact_truth.h"

#include "tests/support/test.h"

#include <limits>

using namespace palpable;
using palpable::test::random_case;
using palpable::test::tolerance;

TEST_CASE("a vertex inside a capsule touches, as deep as it lies under the surface", "[synth]") {
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
  CHECK(vertices_inside(hand, vertices) == std::vector<int>{1, 2});
}

TEST_CASE("without a touch the truth says how far the hand is", "[synth]") {
  const std::vector<Capsule> hand = {{{0, 0, 0}, {1, 0, 0}, 0.5, 0.5}};
  Eigen::Matrix3Xd vertices(3, 1);
  vertices.col(0) << 0.5, 0, 2.0;
  const ContactTruth truth = contact_truth(hand, vertices);
  CHECK_FALSE(truth.touching);
  CHECK(truth.depth == 0.0);
  CHECK(truth.vertex == -1);
  CHECK(truth.clearance == 1.5);
}

TEST_CASE("no hand touches nothing", "[synth]") {
  const ContactTruth truth = contact_truth({}, Eigen::Matrix3Xd::Zero(3, 4));
  CHECK_FALSE(truth.touching);
  CHECK(truth.depth == 0.0);
}

TEST_CASE("skipping far capsules changes nothing", "[synth]") {
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
  }
}
