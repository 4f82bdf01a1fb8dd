#include "palpable/bake/solid/obstacle_jump.h"

#include "tests/support/meshes.h"
#include "tests/support/test.h"

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Eigen::Vector3d;

// 20 x 20 x 60 mm, standing on Z = 0.
SurfaceMesh bar() { return box_surface({-0.01, -0.01, 0}, {0.01, 0.01, 0.06}); }

ObstacleMotion moving(Capsule capsule, const Vector3d& by) {
  return [=](double t) {
    Capsule now = capsule;
    now.a += t * by;
    now.b += t * by;
    return Obstacle{.capsules = {now}};
  };
}

TEST_CASE("an obstacle that goes through a body within a step is seen", "[solid][obstacle]") {
  const ObstacleMotion through = moving(ball({0.1, 0, 0.03}, 0.004), {-0.2, 0, 0});
  const auto overlap = overlap_between(through, bar(), 0.0, 1.0);
  REQUIRE(overlap);
  // No vertex of the box is on the way: what is seen is the centre between x = 10 and -10 mm.
  const double sample = 0.0025 / 0.2;
  CHECK(overlap->begin == Approx(0.09 / 0.2).margin(sample));
  CHECK(overlap->end == Approx(0.11 / 0.2).margin(sample));
  // With that many steps, one ends inside.
  const int steps = steps_to_meet(*overlap);
  CHECK(steps > 30);
  CHECK(steps < 100);
  // A needle passes between the corners of the skin; only its axis is inside.
  CHECK(overlap_between(moving(ball({0.1, 0.001, 0.03}, 1e-4), {-0.2, 0, 0}), bar(), 0.0, 1.0));
  // Capsules, likewise, and surfaces.
  CHECK(overlap_between(moving({{0, 0, 0.2}, {0, 0.01, 0.2}, 0.008, 0.008}, {0, 0, -0.3}), bar(),
                        0.0, 1.0));
}

TEST_CASE(
    "an obstacle that touches a body and then goes through it is seen, one that leaves is not",
    "[solid][obstacle]") {
  const Capsule at_the_skin = ball({0.0139, 0, 0.03}, 0.004);  // 0.1 mm in the face at x = 10 mm
  const auto seen = [&](const Vector3d& by) {
    return overlap_between(moving(at_the_skin, by), bar(), 0.0, 1.0, OverlapOf::kCore).has_value();
  };
  CHECK(seen({-0.05, 0, 0}));
  CHECK_FALSE(seen({0.05, 0, 0}));
  CHECK_FALSE(seen({0, 0.05, 0}));  // it slides off, 0.1 mm inside
}

TEST_CASE("an obstacle that passes a body by is not seen", "[solid][obstacle]") {
  CHECK_FALSE(
      overlap_between(moving(ball({0.1, 0.02, 0.03}, 0.004), {-0.2, 0, 0}), bar(), 0.0, 1.0));
  CHECK_FALSE(overlap_between(moving(ball({0.1, 0, 0.03}, 0.004), {-0.05, 0, 0}), bar(), 0.0, 1.0));
  CHECK_FALSE(overlap_between(moving(ball({0.05, 0.05, 0.07}, 0.004), {0, 0, -0.1}), bar(), 0, 1));
}

TEST_CASE("a body inside an obstacle, or behind its plane, is named", "[solid][obstacle]") {
  CHECK_THAT(swallowed_text({.capsules = {ball({0, 0, 0.07}, 8.0)}}, bar()),
             Contains("20 x 20 x 60 mm") && Contains("inside the obstacle at the start") &&
                 Contains("metres"));
  CHECK_THAT(swallowed_text({.half_spaces = {{{0, 0, 0.07}, {0, 0, 1}}}}, bar()),
             Contains("behind the plane at the start") && Contains("reverse it"));
  CHECK(swallowed_text({.half_spaces = {{{0, 0, 0.07}, {0, 0, -1}}}}, bar()).empty());
  CHECK(swallowed_text({.half_spaces = {{{0, 0, 0.03}, {0, 0, 1}}}}, bar()).empty());  // in part
  CHECK(swallowed_text({.capsules = {ball({0, 0, 0.07}, 0.008)}}, bar()).empty());
}

}  // namespace
}  // namespace palpable
