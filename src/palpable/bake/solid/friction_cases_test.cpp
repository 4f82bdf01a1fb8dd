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
  CHECK(slip.least_lost >= -tolerance(1e-3, "elastic slip that is given back"));
  CHECK(std::abs(slip.energy_error) <= tolerance(3e-3, "32 steps; a point's force within a step"));
}

TEST_CASE("a ball at rest holds the skin for 20 s", "[solid][contact][friction]") {
  const double early = creep_at_rest(4, 0.3, 10);
  CHECK(early <=
        tolerance(5e-6, "m; the last step is solved to 1e-6 of the size, 0.17 m, at each point"));
  CHECK(creep_at_rest(4, 0.3, 600) - early <= tolerance(1e-6, "m in 20 s; no drift"));
}

TEST_CASE("half the step gives the same state of a dragged ball",
          "[solid][contact][friction][long]") {
  CHECK(change_with_half_step(5, 0.3, 0.625e-3) <=
        tolerance(0.01, "what slips slides in one direction within a step"));
}

TEST_CASE("a ball dragged on a block sticks and slips as Cattaneo and Mindlin say, there and back",
          "[solid][contact][friction][long]") {
  // Of finer meshes: see bench friction. 8 cells: 2, 0.6 and 0.8 %.
  const MindlinResult result = drag_mindlin_block(6);
  CHECK(result.stick_radius_error <=
        tolerance(0.06, "a third of a cell; the rim of the circle that sticks lies between nodes"));
  CHECK(result.displacement_error <= tolerance(0.02, "pressures near the rim; half with 8 cells"));
  CHECK(result.unloading_error <= tolerance(0.02, "the same"));
  CHECK(std::abs(result.compliance_error) <=
        tolerance(0.25, "the far faces at six radii, which are held"));
  CHECK(std::abs(result.elastic_slip) <= tolerance(0.01, "k_t is 30 times the nodes' stiffness"));
  CHECK(result.cone_error <= tolerance(1e-3, "of the friction force; its limit is an update late"));
}

TEST_CASE("a strip round a cylinder has the tensions of the capstan",
          "[solid][contact][friction][long]") {
  const CapstanResult result = slide_strip(80, 0.4);
  CHECK(result.angle > 0.6);
  CHECK(result.ratio > 1.2);
  CHECK(std::abs(result.error) <=
        tolerance(0.01, "80 elements, some 30 round the cylinder; bending of the strip"));
  CHECK(result.sticking == 0);
}

}  // namespace
}  // namespace palpable
