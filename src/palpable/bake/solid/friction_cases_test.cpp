// Friction against closed forms: Coulomb's angle, Cattaneo and Mindlin, the capstan; rest, energy,
// steps.
#include "palpable/bake/solid/friction_cases.h"

#include "tests/support/test.h"

#include <cmath>

namespace palpable {
namespace {

using test::tolerance;

TEST_CASE("a plate slides on a held block at Coulomb's angle, not before, and never beyond",
          "[solid][contact][friction]") {
  const SlipResult slip = pull_plate(4, 0.3, 32);
  CHECK(std::abs(slip.angle_error) <= tolerance(2e-3, "points slide aside by a few degrees"));
  CHECK(slip.largest_ratio <= 1.0 + tolerance(1e-3, "the change at the last update"));
  CHECK(slip.least_sliding <= slip.largest_ratio);  // there are states in which all points slide
  CHECK(slip.least_sliding >= 1.0 - tolerance(0.01, "points slide aside by a few degrees"));
  CHECK(slip.least_dissipated >= -tolerance(1e-15, "rounding, J"));
  CHECK(std::abs(slip.energy_error) <= tolerance(0.03, "32 steps; a point's force within a step"));
}

TEST_CASE("a ball at rest holds the skin for 20 s", "[solid][contact][friction]") {
  CHECK(creep_at_rest(4, 0.3, 600) <=
        tolerance(5e-6, "m; points are held to 1e-6 of the size, 0.17 m, and do not drift"));
}

TEST_CASE("half the step gives the same state of a dragged ball",
          "[solid][contact][friction][long]") {
  CHECK(change_with_half_step(5, 0.3, 0.625e-3) <=
        tolerance(0.02, "each new contact point is wrong by a part of a step's slide"));
}

TEST_CASE("a ball dragged on a block sticks and slips as Cattaneo and Mindlin say, there and back",
          "[solid][contact][friction][long]") {
  const MindlinResult result = drag_mindlin_block(10);
  // Five cells across the contact radius: the rim of the circle that sticks lies within one.
  CHECK(result.stick_radius_error <=
        tolerance(0.15, "two thirds of a cell of five; points lie a fifth apart"));
  CHECK(result.displacement_error <= tolerance(0.06, "pressures of a mesh of five cells"));
  CHECK(result.unloading_error <= tolerance(0.06, "the same"));
  CHECK(result.least_dissipated >= -tolerance(1e-15, "rounding, J"));
}

TEST_CASE("a strip round a cylinder has the tensions of the capstan",
          "[solid][contact][friction][long]") {
  const CapstanResult result = slide_strip(80, 0.4);
  CHECK(result.angle > 0.6);
  CHECK(result.ratio > 1.2);
  CHECK(std::abs(result.error) <=
        tolerance(0.03, "80 elements, some 30 round the cylinder; bending of the strip"));
  CHECK(result.sticking == 0);
}

}  // namespace
}  // namespace palpable
