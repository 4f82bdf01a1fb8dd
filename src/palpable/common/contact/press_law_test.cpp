#include "palpable/common/contact/press_law.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/contact/paper_contact.h"
#include "tests/support/allocations.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/seen_surface.h"
#include "tests/support/test.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using test::tolerance;

constexpr double kFinger = 0.008;  // m, radius
constexpr float kSigma = 0.001f;   // m, standard deviation of the surface

/// A finger that points along -`direction`, as balls on its axis. Its tip is `depth` inside the
/// sphere around (0, 0, radius).
std::vector<ObjectBall> finger(const test::DentedSphere& sphere, const Vector3d& direction,
                               double depth, float sigma = kSigma) {
  const Vector3d d = direction.normalized();
  const Vector3d tip = Vector3d(0, 0, sphere.radius) + (sphere.radius - depth) * d;
  std::vector<ObjectBall> balls;
  for (double along = kFinger; along < 0.045; along += 0.0005) {
    const Vector3d centre = tip + along * d, side = d.unitOrthogonal();
    balls.push_back({(centre + kFinger * side).cast<float>(), side.cast<float>(),
                     centre.cast<float>(), static_cast<float>(kFinger), sigma});
  }
  return balls;
}

struct Loop {
  explicit Loop(const PressSettings& settings = {}, double dent_width = 0.012)
      : sphere{.width = dent_width}, law(body, settings) {}

  /// Advances `frames` frames with the same balls; the press follows by a third per frame at most.
  const std::optional<Touch>& see(const std::vector<ObjectBall>& balls, int frames = 1) {
    seen.build(balls, region);
    for (int i = 0; i < frames; ++i) {
      state = law.advance(state, seen, time);
      time += 1.0 / 30;
    }
    return state.touch;
  }

  test::DentedSphere sphere;
  ReducedBody body = sphere.body();
  Eigen::AlignedBox3d region{Vector3d(-0.05, -0.05, 0), Vector3d(0.05, 0.05, 0.1)};
  PressLaw law;
  ObjectSurface seen;
  PressState state;
  double time = 0;
};

double deepest_left(const Loop& loop) {
  Eigen::Matrix3Xf x = loop.body.surface.vertices.cast<float>();
  if (loop.state.touch) {
    Eigen::Matrix3Xf u(3, x.cols());
    loop.body.displacement.evaluate(
        std::array{static_cast<double>(loop.state.touch->site), loop.state.touch->level},
        std::span<float>(u.data(), static_cast<std::size_t>(u.size())));
    x += u;
  }
  double deepest = 0;
  for (Eigen::Index k = 0; k < x.cols(); ++k) {
    const auto nearest = loop.seen.nearest_by_brute_force(x.col(k));
    if (nearest) deepest = std::max(deepest, -static_cast<double>(nearest->distance));
  }
  return deepest;
}

TEST_CASE("the level puts the touched skin on the measured surface", "[contact][law]") {
  // Without noise there is no tolerance and no hysteresis: the press is exact.
  Loop loop;
  for (const double depth : {0.002, 0.005, 0.009, 0.013, 0.004}) {
    INFO("depth " << depth);
    const auto& touch = loop.see(finger(loop.sphere, {0, -1, 0}, depth, 0), 4);
    REQUIRE(touch.has_value());
    CHECK(touch->site == 1);
    // The vertex under the tip moves by depth(level) exactly.
    CHECK(loop.sphere.depth(touch->level) >= depth - tolerance(2e-4, "vertex 0.1 mm off"));
    CHECK(loop.sphere.depth(touch->level) <=
          depth + tolerance(0.0035, "neighbours, 6 mm aside, move less than the middle"));
    CHECK(deepest_left(loop) < tolerance(2e-4, "bisection to 1/128 of a level step"));
    CHECK(touch->force == Approx(3.0 * touch->level));
    CHECK(touch->direction == loop.body.sites[1].direction);
    CHECK(touch->press_depth == Approx(press_depth_of_level(loop.body, 1, touch->level)));
  }
}

TEST_CASE("a press deeper than the finger is thick is still a press", "[contact][law]") {
  Loop loop;
  // A short finger whose far end has passed the skin's position at rest.
  std::vector<ObjectBall> tip = finger(loop.sphere, {0, 0, 1}, 0.014);
  loop.see(tip, 4);
  REQUIRE(loop.state.touch);
  const double before = loop.state.touch->level;
  std::vector<ObjectBall> sunk(tip.begin(), tip.begin() + 1);
  sunk[0].centre.z() -= 0.007f;
  loop.seen.build(sunk, loop.region);
  // No point of the body at rest is inside any more, but the ball is inside the body.
  for (const SkinPoint& point : loop.law.skin()) {
    const auto found = loop.seen.nearest(point.at(loop.body.surface.vertices.cast<float>()));
    CHECK_FALSE((found && found->distance < 0));
  }
  const auto region = loop.law.touched_region(loop.seen);
  REQUIRE(region.has_value());
  CHECK(region->depth == Approx(0.020).margin(tolerance(5e-4, "sigma is 1 mm; facets 0.4 mm")));
  loop.see(sunk);
  REQUIRE(loop.state.touch);
  CHECK(loop.state.touch->level >= before - 1e-9);
}

TEST_CASE("an object that the skin would meet from behind does not press it", "[contact][law]") {
  // A finger presses the top a little; another lies where the top would be if it were pressed
  // fully. It pushes up, not down.
  Loop loop;
  auto balls = finger(loop.sphere, {0, 0, 1}, 0.004);
  loop.seen.build(balls, loop.region);
  const double alone = loop.law.demanded_level(0, loop.seen).level;
  CHECK(alone > 0.05);
  const Vector3f below(0, 0, 0.1f - 0.015f - 0.006f);
  balls.push_back({below, {0, -1, 0}, below, 0.008f, kSigma});
  loop.seen.build(balls, loop.region);
  CHECK(loop.law.demanded_level(0, loop.seen).level == Approx(alone));
}

TEST_CASE("the tip of a pencil between three vertices is detected", "[contact][law]") {
  Loop loop;
  // The middle of the triangle at the top that is farthest from its corners.
  const Eigen::Matrix3Xd& x = loop.body.surface.vertices;
  const Eigen::Vector3i corner = loop.body.surface.triangles.col(0);
  const Vector3d middle = (x.col(corner[0]) + x.col(corner[1]) + x.col(corner[2])) / 3;
  const Vector3d out = (middle - Vector3d(0, 0, loop.sphere.radius)).normalized();
  const float r = 0.0015f;
  const auto pencil = [&](double depth) {
    std::vector<ObjectBall> balls;
    for (double along = 0; along < 0.03; along += 0.0005) {
      const Vector3f c = (middle + (along - depth + 0.0015) * out).cast<float>();
      balls.push_back({c, out.cast<float>(), c, r, 0.0002f});
    }
    return balls;
  };
  const double apart = (x.col(corner[0]) - middle).norm();
  REQUIRE(apart > 2 * static_cast<double>(r));
  CHECK(loop.see(pencil(0.002)).has_value());
}

TEST_CASE("a hand that leaves between two frames leaves the body at rest", "[contact][law]") {
  Loop loop;
  REQUIRE(loop.see(finger(loop.sphere, {0, 0, 1}, 0.010)).has_value());
  CHECK_FALSE(loop.see(finger(loop.sphere, {0, 0, 1}, -0.2)).has_value());

  // With Algorithm 1 the same two frames leave the body pressed for ever.
  const PaperSettings settings;
  PaperState paper;
  PaperNodes nodes(loop.body, QueriedNodes::kSites);
  for (int frame = 0; frame < 20; ++frame) {
    loop.seen.build(finger(loop.sphere, {0, 0, 1}, frame < 5 ? 0.0 : -0.2), loop.region);
    nodes.deform(paper, loop.body);
    paper = advance_as_printed(paper, nearest_by_all_pairs(nodes, loop.seen.cloud()), 10, settings);
  }
  CHECK(paper.step > 0);
}

TEST_CASE("a full press takes a few frames at 30 Hz, not as many as there are levels",
          "[contact][law]") {
  Loop loop;
  loop.see({});
  int frames = 0;
  while (frames < 20 && (!loop.state.touch || loop.state.touch->level < 0.8)) {
    loop.see(finger(loop.sphere, {0, 0, 1}, 0.02));
    ++frames;
  }
  CHECK(frames <= 6);
  CHECK(frames >= 2);
}

TEST_CASE("without a seen object there is no touch", "[contact][law]") {
  Loop loop;
  CHECK_FALSE(loop.see({}).has_value());
  REQUIRE(loop.see(finger(loop.sphere, {0, 0, 1}, 0.010)).has_value());
  CHECK_FALSE(loop.see({}).has_value());
}

TEST_CASE("a surface that hovers within its noise does not press", "[contact][law]") {
  Loop loop;
  for (int frame = 0; frame < 60; ++frame) {
    const double depth = 0.0008 * std::sin(frame * 1.7);
    CHECK_FALSE(loop.see(finger(loop.sphere, {0, 0, 1}, depth)).has_value());
  }
  CHECK(loop.see(finger(loop.sphere, {0, 0, 1}, 0.0022)).has_value());
}

TEST_CASE("a pressed body does not tremble with the noise", "[contact][law]") {
  Loop loop;
  loop.see(finger(loop.sphere, {0, 0, 1}, 0.008), 4);
  REQUIRE(loop.state.touch);
  const double rest = loop.state.touch->level;
  for (int frame = 0; frame < 60; ++frame) {
    const auto& touch =
        loop.see(finger(loop.sphere, {0, 0, 1}, 0.008 + 0.0003 * std::sin(frame * 1.7)));
    REQUIRE(touch.has_value());
    CHECK(touch->level ==
          Approx(rest).epsilon(
              tolerance(1e-5, "held, except for the conversion from depth to level and back")));
  }
}

TEST_CASE("one frame's small error moves the press by less than half of it", "[contact][law]") {
  const auto press_of = [](Loop& loop, double depth, int frames) {
    const auto touch = loop.see(finger(loop.sphere, {0, 0, 1}, depth), frames);
    return touch.value_or(Touch{}).press_depth;
  };
  Loop calm;
  Loop prompt({.hysteresis = 0, .least_follow = 1});
  const double before = press_of(calm, 0.004, 20);
  // 1.5 mm more, and sigma is 1 mm.
  const double demanded = press_of(prompt, 0.0055, 20);
  const double once = press_of(calm, 0.0055, 1);
  REQUIRE(demanded > before + 5e-4);
  CHECK(once >= before);
  CHECK(once - before < 0.5 * (demanded - before));
  CHECK(press_of(calm, 0.0055, 20) > once);
}

TEST_CASE("the tolerance is the surface's own sigma", "[contact][law]") {
  Loop loop;
  CHECK(loop.see(finger(loop.sphere, {0, 0, 1}, 0.004)).has_value());
  loop.see({});
  CHECK_FALSE(loop.see(finger(loop.sphere, {0, 0, 1}, 0.004, 0.006f)).has_value());
}

TEST_CASE("the desk does not touch the base that the support holds", "[contact][law]") {
  Loop loop;
  std::vector<ObjectBall> desk;
  for (int i = -40; i <= 40; ++i) {
    for (int j = -40; j <= 40; ++j) {
      const Vector3f y(0.002f * static_cast<float>(i), 0.002f * static_cast<float>(j), 0.001f);
      desk.push_back({y, {0, 0, 1}, y - Vector3f(0, 0, 0.008f), 0.008f, kSigma});
    }
  }
  CHECK_FALSE(loop.see(desk).has_value());
}

TEST_CASE("the press follows a hand that wanders to another site without a jump",
          "[contact][law]") {
  Loop loop;
  double level = 0;
  int site = -1;
  int changes = 0;
  // From the top to the front in three seconds, 10 mm deep all the way.
  for (int frame = 0; frame <= 90; ++frame) {
    const double angle = frame / 90.0 * std::numbers::pi / 2;
    const auto& touch =
        loop.see(finger(loop.sphere, {0, -std::sin(angle), std::cos(angle)}, 0.010));
    const double now = touch ? touch->level : 0;
    if (frame > 0) {
      INFO("frame " << frame << " level " << level << " -> " << now);
      CHECK(std::abs(now - level) <= 10.0 / 30 + 1e-9);
    }
    if (touch && touch->site != site) {
      if (site >= 0) { ++changes; }
      site = touch->site;
    }
    level = now;
  }
  CHECK(changes == 1);
  CHECK(site == 1);
  CHECK(level > 0.3);
}

TEST_CASE("the site is kept while it is pressed and the hand only trembles between two",
          "[contact][law]") {
  // Sites 0 and 1 are 90 degrees apart, and each dent reaches beyond the middle between them.
  Loop loop({}, 0.035);
  const auto between = [](double angle) { return Vector3d(0, -std::sin(angle), std::cos(angle)); };
  const double middle = std::numbers::pi / 4;
  loop.see(finger(loop.sphere, between(middle - 0.15), 0.008));
  REQUIRE(loop.state.touch);
  REQUIRE(loop.state.touch->site == 0);
  for (int frame = 0; frame < 40; ++frame) {
    const double angle = middle + 0.15 * std::sin(frame * 0.9);
    const auto& touch = loop.see(finger(loop.sphere, between(angle), 0.008));
    REQUIRE(touch.has_value());
    CHECK(touch->site == 0);
  }
}

TEST_CASE("a point that is inside by less than sigma demands nothing", "[contact][law]") {
  Loop loop;
  constexpr float kCoarse = 0.0048f;
  loop.seen.build(finger(loop.sphere, {0, 0, 1}, 0.004, kCoarse), loop.region);
  CHECK(loop.law.demanded_level(0, loop.seen).level == 0);
  CHECK(loop.law.demanded_level(0, loop.seen, 0.5).level > 0);
  loop.seen.build(finger(loop.sphere, {0, 0, 1}, 0.007, kCoarse), loop.region);
  CHECK(loop.law.demanded_level(0, loop.seen).level > 0);
}

TEST_CASE("a touch between the sites presses the nearest one", "[contact][law]") {
  Loop loop;
  const auto& touch = loop.see(finger(loop.sphere, {0, -0.62, 0.78}, 0.006, 0), 3);
  REQUIRE(touch.has_value());
  CHECK(touch->site == 0);
  const auto region = loop.law.touched_region(loop.seen);
  REQUIRE(region.has_value());
  CHECK(region->ball_count >= 2);
  CHECK(region->depth == Approx(0.006).margin(tolerance(4e-4, "facets lie within the sphere")));
  CHECK(loop.sphere.depth(touch->level) >=
        region->depth - tolerance(1e-4, "from depth to level and back, in 10 samples"));
}

TEST_CASE("for any seen object the state stays admissible", "[contact][law]") {
  for (unsigned seed = 0; seed < 8; ++seed) {
    INFO("seed " << seed);
    auto random = test::random_case(seed);
    std::normal_distribution<double> some;
    std::uniform_real_distribution<double> depth(-0.02, 0.06);
    Loop loop;
    for (int frame = 0; frame < 30; ++frame) {
      auto points = finger(loop.sphere, {some(random), some(random), some(random)}, depth(random));
      for (ObjectBall& ball : points)
        ball.centre += 0.002f * Vector3f(static_cast<float>(some(random)), 0, 0);
      const auto& touch = loop.see(points);
      if (!touch) continue;
      CHECK((0 <= touch->site && touch->site < 5));
      CHECK((0 < touch->level && touch->level <= 1));
      CHECK(touch->press_depth > 0);
      CHECK(touch->point_in_body.allFinite());
    }
  }
}

TEST_CASE("a frame of contact allocates nothing", "[contact][frame loop]") {
  Loop loop;
  loop.see(finger(loop.sphere, {0, 0, 1}, 0.006));
  const PressState before = loop.state;
  PressState after;
  CHECK(test::allocations_during([&] { after = loop.law.advance(before, loop.seen, loop.time); }) ==
        0);
  CHECK(after.touch.has_value());
}

TEST_CASE("press depth and level are each other's inverse", "[contact]") {
  const Loop loop;
  for (double level = 0; level <= 1.0; level += 0.037) {
    CHECK(level_of_press_depth(loop.body, 2, press_depth_of_level(loop.body, 2, level)) ==
          Approx(level).margin(tolerance(2e-4, "10 levels, and the inverse of a cubic is none")));
  }
  CHECK(press_depth_of_level(loop.body, 2, -1) == 0);
  CHECK(press_depth_of_level(loop.body, 2, 2) == loop.body.press_depth(10, 2));
}

TEST_CASE("a site's path has its patch and the points that move with it, and no fixed vertex",
          "[contact]") {
  const Loop loop;
  const auto skin = loop.law.skin();
  const auto paths = press_paths(loop.body, skin, 0.5);
  REQUIRE(paths.size() == 5);
  const Eigen::Matrix3Xf X = loop.body.surface.vertices.cast<float>();
  for (std::size_t s = 0; s < 5; ++s) {
    const auto& points = paths[s].points;
    for (const int k : loop.body.sites[s].patch) {
      CHECK(std::any_of(points.begin(), points.end(), [&](int p) {
        const SkinPoint& point = skin[static_cast<std::size_t>(p)];
        return point.weights[0] == 1 && point.corners[0] == k;
      }));
    }
    CHECK(points.size() > 3 * loop.body.sites[s].patch.size());  // those in the triangles
    CHECK(paths[s].positions.cols() == static_cast<Eigen::Index>(points.size()) * 11);
    // Column j L + l: the first point, a vertex, at rest and at the last level.
    const SkinPoint& first = skin[points.front()];
    REQUIRE(first.weights[0] == 1);
    CHECK(paths[s].positions.col(0) == X.col(first.corners[0]));
    Vector3f u;
    loop.body.displacement.evaluate_part(std::array{static_cast<double>(s), 1.0},
                                         3 * first.corners[0], std::span<float>(u.data(), 3));
    CHECK((paths[s].positions.col(10) - paths[s].positions.col(0) - u).norm() < 1e-8f);
  }
}

TEST_CASE("level_that_moves() inverts the displacement of a site's vertex", "[contact]") {
  const Loop loop;
  const auto paths = press_paths(loop.body, loop.law.skin(), 0.5);
  for (double level = 0; level <= 1.0; level += 0.037) {
    CHECK(level_that_moves(paths[1], loop.body.levels(), loop.sphere.depth(level)) ==
          Approx(level).margin(tolerance(0.004, "linear within a tenth of a parabola")));
  }
  CHECK(level_that_moves(paths[1], loop.body.levels(), -1) == 0);
  CHECK(level_that_moves(paths[1], loop.body.levels(), 1) == 1);
}

TEST_CASE("settings out of range are refused", "[contact][errors]") {
  const ReducedBody body = test::DentedSphere{}.body();
  CHECK_THROWS_AS(PressLaw(body, {.spacing = 0}), ContractViolation);
  CHECK_THROWS_AS(PressLaw(body, {.tolerance = -1}), ContractViolation);
  CHECK_THROWS_AS(PressLaw(body, {.hysteresis = 1.5}), ContractViolation);
  CHECK_THROWS_AS(PressLaw(body, {.least_share = 0}), ContractViolation);
  CHECK_THROWS_AS(PressLaw(body, {.least_follow = 0}), ContractViolation);
  CHECK_THROWS_AS(PressLaw(body, {.fastest = 0}), ContractViolation);
}

TEST_CASE("a body as large as a house has no more points than memory holds", "[contact]") {
  ReducedBody body = test::DentedSphere().body();
  body.surface.vertices *= 1000;
  const PressLaw large(body, {});
  CHECK(large.skin().size() < 150000);
  CHECK(large.skin().size() > 10000);
}

}  // namespace

}  // namespace palpable
