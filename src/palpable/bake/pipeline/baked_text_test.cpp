#include "palpable/bake/pipeline/baked_text.h"

#include "tests/support/bodies.h"
#include "tests/support/test.h"

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Catch::Matchers::EndsWith;
using Catch::Matchers::StartsWith;

BakedBody example() {
  BakedBody baked{.body = test::pressed_ball(0.05, 0.01, 2, 5), .report = {}};
  BakeReport& report = baked.report;
  report.nodes = 500;
  report.tets = 2000;
  report.outcomes.resize(6);
  report.displacement = {.method = "per-site",
                         .modes = 3,
                         .columns = 17,
                         .errors = Eigen::Vector3d(0.5, 0.25, 0.0625),
                         .pooled = 0.01,
                         .worst = 0.02};
  report.stress = {.method = "pgd",
                   .modes = 2,
                   .columns = 2,
                   .errors = Eigen::Vector2d(0.75, 0.125),
                   .pooled = 0.03,
                   .worst = 0.04};
  return baked;
}

TEST_CASE("the text of a baked body lists errors, sizes and methods", "[pipeline][text]") {
  CHECK(text_of(example()) ==
        "\nrelative error against the number of modes\n"
        " modes   displacement     stress\n"
        "     1       5.00e-01   7.50e-01\n"
        "     2       2.50e-01   1.25e-01\n"
        "     3       6.25e-02          -\n"
        "\n"
        "500 nodes, 2000 tetrahedra; 6 sites x 4 levels, 6 reach the press\n"
        "displacement: per-site, 3 modes at most, 17 in all, error 0.01 pooled, 0.02 at the worst "
        "snapshot\n"
        "stress: pgd, 2 modes, error 0.03 pooled, 0.04 at the worst snapshot\n");
}

TEST_CASE("the text of a baked body lists what was not reached", "[pipeline][text]") {
  BakedBody baked = example();
  BakeReport& report = baked.report;
  report.outcomes[4] = {.reached_press = false, .press = 0.002, .shortfall = "it buckles"};
  report.stress.reached = false;
  baked.body.error.stress_rounding = 2e-4;
  report.between_sites = "wrong by a third";
  report.held_out = "half as good";
  const std::string text = text_of(baked);
  CHECK_THAT(text, Contains("\nsite 4: pressed 0.002 m in only, by ") &&
                       Contains(" N: it buckles\n") && Contains("4 levels, 5 reach the press\n") &&
                       Contains("0.04 at the worst snapshot; stored in half precision, which adds "
                                "2.0e-04 (the tolerance was not reached: raise max_modes)\n") &&
                       EndsWith("\nbetween sites: wrong by a third\nheld out: half as good\n"));
}

TEST_CASE("the text of a body learnt from a part has its errors on the rest, and no course",
          "[pipeline][text]") {
  BakedBody baked = example();
  for (ReductionReport* report : {&baked.report.displacement, &baked.report.stress}) {
    report->method = "sparse-pgd";
    report->errors.resize(0);
    report->learning = LearningReport{8, "x and y", {16, 0.011, 0.012, 0.025}};
  }
  CHECK_THAT(text_of(baked),
             StartsWith("\n500 nodes") &&
                 Contains("displacement: sparse-pgd, 3 modes, error 0.01 pooled, 0.02 at the worst "
                          "snapshot; learnt from 8 snapshots, of the 16 others 0.011 pooled, 0.025 "
                          "at the worst\n"));
}

TEST_CASE("a field without modes has a dash in the table of errors", "[pipeline][text]") {
  BakedBody baked = example();
  baked.report.stress.errors.resize(0);
  CHECK_THAT(text_of(baked), StartsWith("\nrelative error against the number of modes\n"
                                        " modes   displacement     stress\n"
                                        "     1       5.00e-01          -\n"));
}

}  // namespace
}  // namespace palpable
