// 4-node and 10-node tetrahedra on the same nodes, compared with a finer mesh: a fast version of
// `palpable bench elements`, which does the same for the paper's bunny.
#include "palpable/bake/mesh/tetrahedralise.h"
#include "tests/support/test.h"
#include "tests/verification/record.h"
#include "tests/verification/shapes.h"

#include "bench/bake/element_study.h"
#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

TEST_CASE("10-node tetrahedra are truer than 4-node ones on the same nodes, wherever one presses",
          "[verification][elements][long]") {
  SolidModel model;
  model.mesh = tetrahedralise(test::ball_with_ears(2), "ball with ears");
  const double bottom = model.mesh.nodes.row(2).minCoeff(),
               height = model.mesh.nodes.row(2).maxCoeff() - bottom;
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (model.mesh.nodes(2, n) < bottom + 0.12 * height) model.fixed_nodes.push_back(n);
  }
  const ElementFamily family = nested_family(model);
  const ElementStudy study = study_elements(family, {.sites = 3,
                                                     .lowest = bottom + 0.3 * height,
                                                     .pressed = 2,
                                                     .press = 0.1 * height,
                                                     .poisson = {0.4}});
  constexpr std::size_t kTen = 1, kFour = 2;
  REQUIRE(study.members[kTen].nodes_per_tet == 10);
  REQUIRE(study.members[kTen].nodes == study.members[kFour].nodes);
  const auto percent = [](double value) { return fmt::format("{:.1f} %", 100 * value); };
  for (const ElementPress& press : study.presses) {
    INFO("site " << press.site << ", share " << press.share << ", nu " << press.poisson);
    REQUIRE(press.why_stopped.empty());
    const ElementErrors& ten = press.errors[kTen];
    const ElementErrors& four = press.errors[kFour];
    CHECK(four.press < 0.0);  // too stiff
    CHECK(std::abs(ten.press) < 0.6 * std::abs(four.press));
    CHECK(ten.displacement < 0.6 * four.displacement);
    CHECK(ten.element_von_mises < 0.7 * four.element_von_mises);
    test::record(
        "elements-coarse",
        {{"site", std::to_string(press.site)},
         {"press", press.share == 0 ? "small" : fmt::format("{:.2f} mm", 1e3 * press.press)},
         {"4-node: press off by", fmt::format("{:+.1f} %", 100 * four.press)},
         {"displacement", percent(four.displacement)},
         {"von Mises", percent(four.element_von_mises)},
         {"at nodes", percent(four.nodal_von_mises)},
         {"10-node: press off by", fmt::format("{:+.1f} %", 100 * ten.press)},
         {"displacement ", percent(ten.displacement)},
         {"von Mises ", percent(ten.element_von_mises)},
         {"at nodes ", percent(ten.nodal_von_mises)}});
  }
}

}  // namespace
}  // namespace palpable
