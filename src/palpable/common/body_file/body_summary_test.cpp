#include "palpable/common/body_file/body_summary.h"

#include "tests/support/bodies.h"
#include "tests/support/some_touch_tables.h"
#include "tests/support/test.h"

#include <utility>

namespace palpable {
namespace {

using Catch::Matchers::Contains;

BodyAndTouch only(ReducedBody body) {
  body.material = "neo-hookean, Young's modulus 6e+04 Pa, Poisson's ratio 0.4";
  return {std::move(body), std::optional<TouchTables>(), {}};
}

TEST_CASE("three lines say what a body is, how good it is and how fast", "[body_file][facts]") {
  ReducedBody ball = test::pressed_ball(0.05, 0.01, 3, 5);
  ball.method = "per-site";
  ball.error.displacement_pooled = 0.0012;
  ball.error.displacement_worst = 0.02;
  ball.error.stress_pooled = 0.005;
  ball.error.stress_worst = 0.031;
  const std::string text = body_summary(only(ball), 0.0351, 12'340'000);
  CHECK_THAT(text,
             Catch::StartsWith("body:     ball, to be pressed at its 6 sites, one at a time; "));
  CHECK_THAT(text, Contains(" mm; neo-hookean, Young's modulus 60 kPa, Poisson's ratio 0.4\n"
                            "accuracy: reduced model: displacement off by 0.12 % (2 %), stress off "
                            "by 0.5 % (3.1 %) over all snapshots (in the worst)\n"
                            "speed:    0.0351 ms to evaluate displacement and stress of the whole "
                            "skin; 12.3 MB file\n"));
}

TEST_CASE("the errors of a body that is pressed anywhere are first those of its touches",
          "[body_file][facts]") {
  BodyAndTouch content = only(test::pressed_ball());
  TouchTables tables = test::some_touch_tables(content.body.surface, 3);
  tables.held_out = {{PressingThing::kFinger, 0.002, 0.01, 0.02, 0.03, {}},
                     {PressingThing::kRim, 0.003, 0.03, 0.04, 0.05, {}},
                     {PressingThing::kPalm, 0.004, 0.09, 0.06, 0.07, {}}};
  content.touch = std::optional(std::move(tables));
  const std::string text = body_summary(content, 1, 1'000'000);
  CHECK_THAT(text, Contains(", to be pressed anywhere, several touches at a time; "));
  CHECK_THAT(text, Contains("\naccuracy: touches: displacement off by 3 % (9 %), force off by 4 % "
                            "(6 %), stress off by 5 % (7 %) in the median (worst) of 3 against "
                            "full finite elements; "));
}

TEST_CASE("what is not known of a body is not told as 0", "[body_file][facts]") {
  BodyAndTouch foreign = only(test::pressed_ball());
  foreign.body.method.clear();
  foreign.body.error = {};
  CHECK_THAT(body_summary(foreign, 1, 1),
             Contains("accuracy: error of the reduced model not known\n"));
  foreign.touch = Problem{"a table is damaged"};
  CHECK_THAT(body_summary(foreign, 1, 1), Contains("its tables of touch are damaged"));
  BodyAndTouch several = only(test::with_several(test::pressed_ball()));
  CHECK_THAT(body_summary(several, 1, 1),
             Contains("two loads at once: displacement off by 0.4 % (2 %) in the median (worst) of "
                      "6 pairs; "));
}

}  // namespace
}  // namespace palpable
