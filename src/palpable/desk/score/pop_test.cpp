#include "palpable/desk/score/pop.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

namespace palpable {
namespace {

using Eigen::Vector3d;

constexpr double kFar = 10;  // m, X of a hand that touches nothing

// Two vertices at X = 0 and 0.1 m, the first one lifted, and a ball of 10 mm radius as the hand.
PopFrame frame(int number, double lifted, double hand_x) {
  PopFrame f;
  f.number = number;
  f.surface.resize(3, 2);
  f.surface.col(0) = Vector3d(0, 0, lifted);
  f.surface.col(1) = Vector3d(0.1, 0, 0);
  const Vector3d at(hand_x, 0, 0.01);
  f.hand = {{at, at, 0.01, 0.01}};
  return f;
}

TEST_CASE("a jump of 5 mm while the hand moves 2 mm is a pop of 3 mm", "[score]") {
  PopScorer scorer;
  scorer.add(frame(7, 0, 0));
  CHECK_FALSE(scorer.largest().has_value());
  scorer.add(frame(8, 0.005, 0.002));
  REQUIRE(scorer.largest().has_value());
  CHECK(scorer.largest()->size == Approx(0.003));
  CHECK(scorer.largest()->frame == 8);
  scorer.add(frame(9, 0.006, 0.002));  // a smaller pop changes nothing
  CHECK(scorer.largest()->frame == 8);
}

TEST_CASE("pops of more than 4 mm are counted, one by one", "[score]") {
  PopScorer scorer;
  CHECK_FALSE(scorer.counted().has_value());
  int n = 0;
  for (const double lifted : {0.0, 0.005, 0.0, 0.0039, 0.0085, 0.0085}) {
    scorer.add(frame(n++, lifted, kFar));  // 5, 5, 3.9, 4.6 and 0 mm
  }
  CHECK(scorer.counted() == 3);
}

TEST_CASE("a surface that moves with the hand does not pop", "[score]") {
  PopScorer scorer;
  for (int n = 0; n < 10; ++n) scorer.add(frame(n, 0.003 * n, 0.003 * n));
  CHECK(scorer.largest()->size == Approx(0).margin(1e-15));
}

TEST_CASE("a response may be two frames late, not three", "[score]") {
  for (const int late : {1, 2, 3}) {
    INFO("late by " << late);
    PopScorer scorer;
    scorer.add(frame(0, 0, 0));
    for (int n = 1; n < 8; ++n)
      scorer.add(frame(n, n >= 1 + late ? 0.004 : 0, 0.004));  // the hand moves in frame 1
    CHECK(scorer.largest()->size == Approx(late <= 2 ? 0 : 0.004).margin(1e-15));
  }
}

TEST_CASE("a hand that is far away explains nothing", "[score]") {
  PopScorer scorer;
  scorer.add(frame(0, 0, kFar));
  scorer.add(frame(1, 0.004, kFar + 1));
  CHECK(scorer.largest()->size == Approx(0.004));
}

TEST_CASE("a hand that comes into view far away does not stop the comparison, near by it does",
          "[score]") {
  for (const bool near : {false, true}) {
    PopScorer scorer;
    PopFrame before = frame(0, 0, 0);
    before.hand.clear();
    scorer.add(before);
    scorer.add(frame(1, 0.004, near ? 0 : kFar));
    CHECK(scorer.largest().has_value() == !near);
  }
}

TEST_CASE("a jump is found although the frames in between were skipped", "[score]") {
  PopScorer scorer;
  scorer.add(frame(0, 0, kFar));
  scorer.add(frame(5, 0.0045, kFar));
  CHECK(scorer.largest()->size == Approx(0.0045));
  CHECK(scorer.largest()->frame == 5);
  CHECK(scorer.counted() == 1);
  scorer.add(frame(6, 0.0045, 0));
  scorer.add(frame(9, 0.0065, 0.002));  // as far as the hand since frame 6
  CHECK(scorer.largest()->frame == 5);
}

TEST_CASE("the motion of the hand is measured in the world, independently of the camera",
          "[score]") {
  // The camera moves from 30 mm left of the body to 50 mm right of it; the hand, above the body,
  // moves 1 mm to the right.
  PopScorer scorer;
  PopFrame before = frame(0, 0, 0.03);
  before.world_from_camera.translation() = Vector3d(-0.03, 0, 0);
  before.camera_from_body.translation() = Vector3d(0.03, 0, 0);
  PopFrame now = frame(1, 0.004, -0.05 + 0.001);
  now.world_from_camera.translation() = Vector3d(0.05, 0, 0);
  now.camera_from_body.translation() = Vector3d(-0.05, 0, 0);
  scorer.add(before);
  scorer.add(now);
  CHECK(scorer.largest()->size == Approx(0.003));
}

TEST_CASE("the part of the hand that is far away explains nothing either", "[score]") {
  PopScorer scorer;
  for (int n = 0; n < 2; ++n) {
    PopFrame f = frame(n, 0.004 * n, 0);
    f.hand.push_back(frame(n, 0, kFar + n).hand.front());
    scorer.add(f);
  }
  CHECK(scorer.largest()->size == Approx(0.004));
}

TEST_CASE("a surface with another number of vertices is refused", "[score][errors]") {
  PopScorer scorer;
  scorer.add(frame(0, 0, 0));
  PopFrame other = frame(1, 0, 0);
  other.surface.conservativeResize(3, 1);
  CHECK_THROWS_AS(scorer.add(other), ContractViolation);
}

}  // namespace
}  // namespace palpable
