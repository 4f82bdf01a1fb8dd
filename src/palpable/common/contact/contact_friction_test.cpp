// Friction of the contact solver, on cushions whose compliance is known (tests/support).

#include "palpable/common/contact/capsule_obstacles.h"
#include "palpable/common/contact/contact_solver.h"
#include "palpable/common/contact/point_anchor.h"
#include "tests/support/allocations.h"
#include "tests/support/cushion_stack.h"
#include "tests/support/rubbing.h"
#include "tests/support/test.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using Eigen::Matrix3Xf;
using Eigen::Vector3d;
using Eigen::Vector3f;
using test::tolerance;

using test::kApart;
using test::kFinger;
using test::Kind;
using test::kTop;
using test::pointing_down;
using test::Rubbing;
using test::Stack;
using test::with_friction;

constexpr Kind kTables = Kind::kTables, kModes = Kind::kModes;
constexpr int kLeadingModes = 12;

Stack cushion(double mu, Kind kind = kTables) {
  return Stack({kind}, kApart, kind == kModes ? kLeadingModes : 0, with_friction(mu));
}

// N, sums over the points of the first cushion that obstacles press.
struct Sums {
  double normal = 0;                     // of |force - friction|
  double size = 0;                       // of |friction|
  Vector3d friction = Vector3d::Zero();  // of friction
};

Sums sums_of(const Stack& stack) {
  ContactBody& body = stack.layers.front()->body();
  Sums sums;
  for (const PointForce& at : body.forces()) {
    if (at.by >= 0) continue;
    sums.normal += static_cast<double>((at.force - at.friction).norm());
    sums.size += static_cast<double>(at.friction.norm());
    sums.friction += at.friction.cast<double>();
  }
  return sums;
}

// Checks that friction is in the cone at every point.
void check_cone(const Stack& stack, double mu) {
  ContactBody& body = stack.layers.front()->body();
  CHECK(body.anchors().size() == body.forces().size());
  for (const PointForce& at : body.forces()) {
    const auto p = static_cast<double>((at.force - at.friction).norm());
    CHECK(static_cast<double>(at.friction.norm()) <=
          mu * p * (1 + tolerance(5e-3, "p turned within an iteration that was damped")) + 1e-7);
  }
}

// Presses the first cushion to a depth at (0, 0), in frames of 0.6 mm.
void press(Stack& stack, Rubbing& finger, double depth) {
  for (double d = 0.0006; d < depth; d += 0.0006) stack.advance(finger.at(0, 0, d));
  for (int frame = 0; frame < 3; ++frame) stack.advance(finger.at(0, 0, depth));
}

// m, displacement along x of the vertex at the top of the first cushion.
double top_moved(const Stack& stack) {
  const Matrix3Xf rest = stack.layers.front()->cushion.skin.vertices.cast<float>();
  Eigen::Index top = 0;
  rest.row(2).maxCoeff(&top);
  return static_cast<double>(stack.layers.front()->skin()(0, top) - rest(0, top));
}

double largest_difference(const Matrix3Xf& a, const Matrix3Xf& b) {
  return static_cast<double>((a - b).colwise().norm().maxCoeff());
}

TEST_CASE("a finger that presses straight has no resultant of friction", "[contact][friction]") {
  for (const Kind kind : {kTables, kModes}) {
    Stack stack = cushion(1, kind);
    Rubbing finger;
    press(stack, finger, 0.003);
    const Sums sums = sums_of(stack);
    REQUIRE(sums.normal > 0.5);
    check_cone(stack, 1);
    CHECK(sums.friction.head<2>().norm() <
          tolerance(0.1, "points are not symmetric") * sums.normal);
  }
}

TEST_CASE("a finger that is dragged takes the skin along, until it slides", "[contact][friction]") {
  for (const Kind kind : {kTables, kModes}) {
    INFO("kind " << static_cast<int>(kind));
    Stack sticks = cushion(2, kind), slips = cushion(0, kind), slides = cushion(0.3, kind);
    Rubbing one, two, three;
    press(sticks, one, 0.003);
    press(slips, two, 0.003);
    press(slides, three, 0.003);
    const double began = top_moved(sticks), began_free = top_moved(slips);
    for (int frame = 1; frame <= 4; ++frame) {
      sticks.advance(one.at(0.00005 * frame, 0, 0.003));
      slips.advance(two.at(0.00005 * frame, 0, 0.003));
    }
    CHECK(top_moved(sticks) - began > 0.8 * 0.0002);
    CHECK(top_moved(sticks) - began < 1.1 * 0.0002);
    // Without friction the top goes along a little, too, because the dent moves.
    CHECK(std::abs(top_moved(slips) - began_free) < 0.7 * 0.0002);
    const Sums held = sums_of(sticks);
    CHECK(held.friction.x() > 0);
    CHECK(held.size < 2 * held.normal);

    for (int frame = 1; frame <= 12; ++frame) slides.advance(three.at(0.0005 * frame, 0, 0.003));
    const Sums rubbed = sums_of(slides);
    REQUIRE(rubbed.normal > 0.3);
    check_cone(slides, 0.3);
    CHECK(rubbed.size > (1 - tolerance(0.1, "points that have just come")) * 0.3 * rubbed.normal);
    CHECK(rubbed.friction.x() > 0.8 * 0.3 * rubbed.normal);
  }
}

TEST_CASE("nothing creeps under a finger that rests", "[contact][friction]") {
  for (const double aside : {0.0, 0.001}) {
    INFO(aside << " m aside");
    Stack stack = cushion(0.3);
    Rubbing finger;
    press(stack, finger, 0.003);
    stack.advance(finger.at(aside, 0, 0.003));
    // Each frame improves the solution by an iteration.
    for (int frame = 0; frame < 30; ++frame) stack.advance(finger.at(aside, 0, 0.003));
    const Matrix3Xf begun = stack.layers[0]->skin();
    const double held = sums_of(stack).friction.x();
    for (int frame = 0; frame < 600; ++frame) stack.advance(finger.at(aside, 0, 0.003));
    CHECK(largest_difference(stack.layers[0]->skin(), begun) <
          tolerance(1e-6, "m: rounding of positions in single precision, over 20 s"));
    CHECK(std::abs(sums_of(stack).friction.x() - held) < tolerance(0.002, "N: likewise"));
  }
}

TEST_CASE("what a finger leaves behind is let go", "[contact][friction]") {
  Stack stack = cushion(0.5);
  Rubbing finger;
  press(stack, finger, 0.003);
  stack.advance(finger.at(0.001, 0, 0.003));
  for (int frame = 0; frame < 4; ++frame) stack.advance(finger.at({}));
  CHECK(stack.layers[0]->body().anchors().empty());
  CHECK(stack.layers[0]->largest_move() == 0);
}

TEST_CASE("two fingers that pinch a cushion hold it", "[contact][friction]") {
  const auto pinched = [](double mu) {
    Stack stack = cushion(mu);
    Rubbing fingers;
    const auto at = [&](double up, double shut) -> const CapsuleObstacles& {
      const Vector3d above(0, 0, kTop + kFinger - shut + up),
          below(0, 0, -kTop - kFinger + shut + up);
      return fingers.at(
          {Capsule{above, above, kFinger, kFinger}, Capsule{below, below, kFinger, kFinger}});
    };
    for (const double shut : {0.0005, 0.001, 0.0015, 0.0015}) stack.advance(at(0, shut));
    // Both move aside along x: the capsules' ends.
    const auto aside = [&](double x) -> const CapsuleObstacles& {
      const Vector3d above(x, 0, kTop + kFinger - 0.0015), below(x, 0, -kTop - kFinger + 0.0015);
      return fingers.at(
          {Capsule{above, above, kFinger, kFinger}, Capsule{below, below, kFinger, kFinger}});
    };
    for (int frame = 1; frame <= 5; ++frame) stack.advance(aside(0.0001 * frame));
    return std::pair(top_moved(stack), sums_of(stack));
  };
  const auto [held, forces] = pinched(1);
  const auto [slipped, none] = pinched(0);
  CHECK(held > 0.7 * 0.0005);
  CHECK(held > 2 * std::abs(slipped));
  CHECK(forces.friction.x() > 0.05);
  CHECK(none.size == 0);
}

TEST_CASE("over random frames friction stays in the cone, and dissipates", "[contact][friction]") {
  for (unsigned seed = 0; seed < 6; ++seed) {
    INFO("seed " << seed);
    auto random = test::random_case(seed);
    std::uniform_real_distribution<double> moves(-0.0008, 0.0008);
    const double mu = 0.1 + 0.2 * seed;
    Stack stack = cushion(mu, seed % 2 == 0 ? kTables : kModes);
    Rubbing finger;
    double x = 0, y = 0, depth = 0.001, all = 0;
    for (int frame = 0; frame < 25; ++frame) {
      x += moves(random);
      y += moves(random);
      depth = std::clamp(depth + moves(random), 0.0002, 0.004);
      stack.advance(finger.at(x, y, depth));
      INFO("frame " << frame);
      check_cone(stack, mu);
      CHECK(stack.report.friction_residual < tolerance(1e-5, "m: half of the iterations'"));
      all += stack.report.dissipated;
    }
    CHECK(all > 0);
  }
}

TEST_CASE("a point that another part presses now goes on with that part", "[contact][friction]") {
  constexpr double kDepth = 0.003, kAside = 0.0004;
  Stack stack = cushion(1);
  Rubbing fingers;
  // Two at the same place: the first one is the nearest.
  const auto advance = [&](double aside, double depth) {
    stack.advance(fingers.at({pointing_down(aside, 0, depth), pointing_down(aside, 0, depth)}));
  };
  for (int k = 1; k <= 6; ++k) advance(0, kDepth / 6 * k);
  for (int k = 1; k <= 4; ++k) advance(kAside / 4 * k, kDepth);
  // The first one rises, and then goes away to the side.
  constexpr double kUp = 0.00002;
  stack.advance(
      fingers.at({pointing_down(kAside, 0, kDepth - kUp), pointing_down(kAside, 0, kDepth)}));
  const double held = sums_of(stack).friction.x();
  const Matrix3Xf begun = stack.layers[0]->skin();
  REQUIRE(held > 0.05);
  for (const PointAnchor& anchor : stack.layers[0]->body().anchors()) CHECK(anchor.part == 1);
  stack.advance(fingers.at({pointing_down(0.06, 0, -0.06), pointing_down(kAside, 0, kDepth)}));
  CHECK(sums_of(stack).friction.x() == Approx(held).epsilon(tolerance(0.02, "iterations")));
  CHECK(largest_difference(stack.layers[0]->skin(), begun) < tolerance(5e-5, "m: iterations"));
}

TEST_CASE("under the step limit friction is let go as the force is", "[contact][friction]") {
  for (const bool stays_known : {true, false}) {
    INFO("the finger is still known: " << stays_known);
    Stack stack = cushion(0.5);
    Rubbing finger;
    press(stack, finger, 0.003);
    for (int k = 1; k <= 4; ++k) stack.advance(finger.at(0.0002 * k, 0, 0.003));
    const std::vector<PointForce> before = stack.layers[0]->state.forces;
    REQUIRE(sums_of(stack).friction.x() > 0.05);
    stack.advance(stays_known ? finger.at(0.0008, 0, -0.02) : finger.at({}), 0.0005);
    const std::vector<PointForce>& now = stack.layers[0]->state.forces;
    REQUIRE(now.size() == before.size());
    const float share = now.front().force.norm() / before.front().force.norm();
    CHECK(share > 0.5f);
    CHECK(share < 1.0f);
    for (std::size_t k = 0; k < now.size(); ++k) {
      CHECK((now[k].friction - share * before[k].friction).norm() <
            tolerance(1e-4f, "rounding") * before[k].force.norm());
    }
  }
}

TEST_CASE("cushions rub each other, and what acts on one acts back on the other",
          "[contact][friction][bodies]") {
  for (const std::vector<Kind>& kinds :
       {std::vector{kTables, kTables}, std::vector{kModes, kTables}}) {
    const auto dragged = [&kinds](double mu) {
      Stack stack(kinds, kApart, kLeadingModes, with_friction(mu));
      Rubbing finger;
      press(stack, finger, 0.006);
      for (int frame = 1; frame <= 6; ++frame) {
        stack.advance(finger.at(0.0002 * frame, 0, 0.006));
        CHECK(stack.report.imbalance < tolerance(1e-6, "N: rounding"));
      }
      const Vector3d up = stack.force(0, true), down = stack.force(1, true);
      CHECK((up + down).norm() < tolerance(1e-6, "N: rounding"));
      return down;
    };
    const Vector3d rubbed = dragged(0.8), free = dragged(0);
    CHECK(rubbed.x() > free.x() + 0.05);
    CHECK(rubbed.z() < -0.2);
  }
}

// That the bytes are those of the program before friction is compared by files of both.
TEST_CASE("a body or a thing without a coefficient takes the path without friction",
          "[contact][friction]") {
  for (const std::vector<Kind>& kinds : {std::vector{kTables}, std::vector{kTables, kModes}}) {
    Stack plain(kinds, kApart, kLeadingModes), zero(kinds, kApart, kLeadingModes, with_friction(0)),
        slippery(kinds.size() == 1 ? kinds : std::vector{kTables}, kApart, kLeadingModes,
                 with_friction(0.5));
    Rubbing finger, grease(0);
    for (const double depth : {0.001, 0.003, 0.006, 0.004}) {
      const CapsuleObstacles& known = finger.at(0.001, -0.002, depth);
      plain.press(depth);
      zero.advance(known);
      for (std::size_t k = 0; k < kinds.size(); ++k) {
        CHECK(plain.layers[k]->skin() == zero.layers[k]->skin());
      }
      CHECK(zero.layers[0]->body().anchors().empty());
      CHECK(zero.report.dissipated == 0);
      if (kinds.size() > 1) continue;
      slippery.advance(grease.at(0.001, -0.002, depth));
      CHECK(plain.layers[0]->skin() == slippery.layers[0]->skin());
    }
  }
}

TEST_CASE("frames with friction give the same bytes, and allocate nothing", "[contact][friction]") {
  for (const std::vector<Kind>& kinds : {std::vector{kTables}, std::vector{kModes, kTables}}) {
    Stack one(kinds, kApart, kLeadingModes, with_friction(0.5)),
        other(kinds, kApart, kLeadingModes, with_friction(0.5));
    Rubbing first, second;
    for (int frame = 0; frame < 8; ++frame) {
      one.advance(first.at(0.0003 * frame, 0, 0.004));
      other.advance(second.at(0.0003 * frame, 0, 0.004));
      for (std::size_t k = 0; k < kinds.size(); ++k) {
        CHECK(one.layers[k]->skin() == other.layers[k]->skin());
      }
    }
    for (int frame = 8; frame < 11; ++frame) {
      const CapsuleObstacles& here = first.at(0.0003 * frame, 0, 0.004);
      CHECK(test::allocations_during([&] { one.advance(here); }) == 0);
    }
  }
}

// --- frames that are divided into steps

// A rod that points down, its tip below the top of the cushion by `depth`, m.
Capsule rod_at(double x, double depth, double radius) {
  const Vector3d tip(x, 0, kTop - depth + radius);
  return {tip, tip + Vector3d(0, 0, 0.04), radius, radius};
}

// The first cushion after a way of things from one pose to another, in a number of frames.
// @param way  the capsules at 0, where the way begins, to 1; from -1 to 0 they come down
template <class Way>
Stack walked(double mu, int frames, const Way& way) {
  Stack stack = cushion(mu);
  Rubbing things;
  for (int k = 0; k <= 10; ++k) stack.advance(things.at(way(0.1 * k - 1)));
  for (int k = 0; k < 3; ++k) stack.advance(things.at(way(0)));
  for (int k = 1; k <= frames; ++k) stack.advance(things.at(way(1.0 * k / frames)));
  return stack;
}

// In one step the points under a thing that moves aside by its radius would lose contact and
// friction, and others would be anchored instead. A needle that sticks is pressed by one or two
// points; things that slide are not chaotic.
TEST_CASE("a thin thing that moves far in a frame holds the skin as in small frames",
          "[contact][friction]") {
  struct Case {
    double mu, radius, far;
  };
  std::vector<Case> cases{{2, 0.0015, 0.0015}};
  for (const double radius : {0.003, 0.004, 0.006}) {
    for (const double radii : {1, 2, 3}) cases.push_back({0.3, radius, radii * radius});
  }
  for (const auto& [mu, radius, far] : cases) {
    INFO("mu " << mu << ", radius " << radius << ", way " << far);
    const auto way = [&, mu = mu, radius = radius, far = far](double t) {
      const double begin = mu < 1 ? -far / 2 : 0;  // slides across the top
      return std::vector<Capsule>{
          rod_at(begin + far * std::max(0.0, t), 0.002 * std::min(1.0, 1 + t), radius)};
    };
    const Stack at_once = walked(mu, 1, way), slowly = walked(mu, 12, way);
    CHECK(at_once.report.steps > 2);
    CHECK(at_once.report.dissipated >= 0);
    check_cone(at_once, mu);
    const Sums fast = sums_of(at_once), slow = sums_of(slowly);
    REQUIRE(slow.friction.x() > 0.2);
    const double within = tolerance(0.01, "iterations; 0.6 % at most") * slow.normal;
    CHECK((fast.friction - slow.friction).norm() < within);
    CHECK(std::abs(fast.normal - slow.normal) < within);
  }
}

TEST_CASE("a thing that turns about its end in a frame rubs as in small frames",
          "[contact][friction]") {
  const auto way = [](double t) {
    const double turned = 0.5 * std::max(0.0, t), depth = 0.002 * std::min(1.0, 1 + t);
    const Vector3d end(-0.01, 0, kTop - depth + 0.004);
    const Vector3d axis(std::cos(turned), std::sin(turned), 0);
    return std::vector<Capsule>{{end, end + 0.02 * axis, 0.004, 0.004}};
  };
  const Stack at_once = walked(0.5, 1, way), slowly = walked(0.5, 12, way);
  CHECK(at_once.report.steps > 1);
  const Sums fast = sums_of(at_once), slow = sums_of(slowly);
  REQUIRE(slow.friction.y() > 0.05);
  // The end of the rod moves aside by more than its radius in each of three steps.
  CHECK((fast.friction - slow.friction).norm() < tolerance(0.12, "steps; 0.09") * slow.normal);
  CHECK(std::abs(fast.normal - slow.normal) < tolerance(0.02, "steps; 0.01") * slow.normal);
}

// In each step a thing is where it is, not where another one's way would put it.
TEST_CASE("what stands still is left alone by what moves beside it", "[contact][friction]") {
  constexpr double kRadius = 0.004;
  const auto both = [](double t) {
    const double depth = 0.002 * std::min(1.0, 1 + t), moved = 0.008 * std::max(0.0, t);
    return std::vector<Capsule>{rod_at(0.006, depth, kRadius),
                                rod_at(-0.010 + moved, depth, kRadius)};
  };
  const Stack at_once = walked(0.3, 1, both), slowly = walked(0.3, 12, both);
  CHECK(at_once.report.steps > 2);
  const auto of_standing = [&](const Stack& stack) {
    Sums sums;
    ContactBody& body = stack.layers.front()->body();
    for (const PointForce& at : body.forces()) {
      const int number = number_of_anchor(body.anchors(), at.point, at.by);
      if (number < 0 || body.anchors()[static_cast<std::size_t>(number)].part != 0) continue;
      sums.normal += static_cast<double>((at.force - at.friction).norm());
      sums.friction += at.friction.cast<double>();
    }
    return sums;
  };
  const Sums fast = of_standing(at_once), slow = of_standing(slowly);
  REQUIRE(slow.normal > 0.3);
  const double within = tolerance(0.03, "iterations, and steps") * slow.normal;
  CHECK(std::abs(fast.normal - slow.normal) < within);
  CHECK((fast.friction - slow.friction).norm() < within);
}

TEST_CASE("a finger that comes fast presses as one that comes slowly", "[contact][friction]") {
  const auto way = [](double t) {
    return std::vector<Capsule>{pointing_down(0, 0, -0.0005 + 0.0035 * std::max(0.0, t))};
  };
  for (const double mu : {0.3, 1.0}) {
    const Stack at_once = walked(mu, 1, way), slowly = walked(mu, 12, way);
    CHECK(at_once.report.steps > 2);
    const Sums fast = sums_of(at_once), slow = sums_of(slowly);
    REQUIRE(slow.normal > 0.5);
    const double within = tolerance(0.02, "iterations, and steps") * slow.normal;
    CHECK(std::abs(fast.normal - slow.normal) < within);
    CHECK(std::abs(fast.size - slow.size) < tolerance(0.05, "likewise") * slow.normal);
  }
}

TEST_CASE("a frame that is divided allocates nothing, and dissipates", "[contact][friction]") {
  for (const std::vector<Kind>& kinds : {std::vector{kTables}, std::vector{kModes, kTables}}) {
    Stack stack(kinds, kApart, kLeadingModes, with_friction(0.3));
    Rubbing rod;
    const auto at = [&](double x, double depth) -> const CapsuleObstacles& {
      return rod.at({rod_at(x, depth, 0.004)});
    };
    for (int k = 1; k <= 8; ++k) stack.advance(at(0, 0.0005 * k));
    stack.advance(at(0.0002, 0.004));
    for (int k = 1; k <= 3; ++k) {
      INFO(kinds.size() << " bodies, frame " << k);
      const CapsuleObstacles& there = at(0.0002 + 0.003 * k, 0.004);
      CHECK(test::allocations_during([&] { stack.advance(there); }) == 0);
      CHECK(stack.report.steps > 2);
      CHECK(stack.report.dissipated > 0);
      CHECK(stack.report.imbalance < tolerance(1e-6, "N: rounding"));
    }
  }
}

TEST_CASE("a point is met where its gap closes", "[contact][friction]") {
  CHECK(time_of_contact(0.003f, -0.001f) == Approx(0.75));
  CHECK(time_of_contact(-0.001f, -0.001f) == 0);  // inside from the begin
  CHECK(time_of_contact(0.003f, 0) == 1);         // not met
}

TEST_CASE("a capsule carries its places along, and does not spin", "[contact][friction]") {
  const Capsule before{{0, 0, 0}, {0, 0, 0.04}, 0.008, 0.008};
  Capsule now = before;
  CapsuleObstacles obstacles;
  const std::vector<int> same{0};
  const std::vector<float> friction{0.5f};
  const MaterialPoint place{0, Vector3f(0.008f, 0.001f, 0.0123f)};

  obstacles.set({&now, 1});
  CHECK(obstacles.largest_friction(0.7f) == 0);
  CHECK_FALSE(obstacles.carried(place));

  obstacles.set_friction(friction, {&before, 1}, same);
  CHECK(obstacles.largest_friction(0.7f) == 0.5f);
  CHECK(obstacles.carried(place)->place == place.place);  // to the bit
  CHECK(obstacles.way_of(place)->isZero(0));

  now.a += Vector3d(0.001, -0.002, 0.003);
  now.b = now.a + Vector3d(0.04, 0, 0);  // from z to x
  obstacles.set({&now, 1});
  obstacles.set_friction(friction, {&before, 1}, same);
  const MaterialPoint carried = *obstacles.carried(place);
  CHECK((carried.place - Vector3f(0.001f + 0.0123f, -0.002f + 0.001f, 0.003f - 0.008f)).norm() <
        tolerance(1e-8, "m: floats"));
  CHECK((*obstacles.way_of(carried) - (carried.place - place.place)).norm() <
        tolerance(1e-8, "m: floats"));

  // On the way, with parts and places as at its end.
  const Obstacles& halfway = *obstacles.on_the_way(0.5f);
  const MaterialPoint there = *halfway.carried(place);
  CHECK(std::abs(gap_at(halfway, there.place).distance -
                 gap_at(obstacles, carried.place).distance) < tolerance(1e-8, "m: floats"));
  CHECK((*halfway.way_of(there) - (there.place - place.place)).norm() <
        tolerance(1e-8, "m: floats"));
  CHECK((gap_at(*obstacles.on_the_way(1), carried.place).distance) ==
        Approx(gap_at(obstacles, carried.place).distance).margin(1e-9));

  const std::vector<int> gone{-1};
  obstacles.set_friction(friction, {&before, 1}, gone);
  CHECK(gap_at(*obstacles.on_the_way(0), carried.place).distance ==
        gap_at(obstacles, carried.place).distance);  // a new one stands
  CHECK_FALSE(obstacles.carried(place));
  CHECK_FALSE(obstacles.way_of(place));
}

}  // namespace
}  // namespace palpable
