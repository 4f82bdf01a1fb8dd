#include "palpable/bake/pipeline/import_figures.h"

#include "tests/support/bodies.h"
#include "tests/support/test.h"

#include <functional>
#include <string>

namespace palpable {
namespace {

using Catch::Matchers::Contains;

// A ball of 100 mm that is pressed by 10 mm, as another program's file would give it.
ImportedFigures usual() {
  return {.size = Eigen::Vector3d::Constant(0.1),
          .displacement = 0.012,
          .stress = 2e4,
          .load = 1.5,
          .patch_pressure = 1e4};
}

std::string only_warning(const std::function<void(ImportedFigures&)>& change) {
  ImportedFigures figures = usual();
  change(figures);
  const std::vector<std::string> warnings = import_warnings(figures);
  REQUIRE(warnings.size() == 1);
  return warnings.front();
}

TEST_CASE("modes in another unit get a warning that names it, usual ones get none",
          "[pipeline][import]") {
  CHECK(import_warnings(usual()).empty());
  CHECK_THAT(only_warning([](ImportedFigures& f) { f.size *= 1000; }),
             Contains("larger than 3 m") && Contains("the vertices in metres, not in mm"));
  CHECK_THAT(only_warning([](ImportedFigures& f) { f.displacement *= 1000; }),
             Contains("moves by 1.2e+04 mm, more than 33.33 mm") && Contains("in mm"));
  CHECK_THAT(only_warning([](ImportedFigures& f) { f.stress *= 1e-6; }), Contains("MPa"));
  CHECK_THAT(only_warning([](ImportedFigures& f) { f.stress *= 1e6; }), Contains("MPa"));
  // A slender body that bends has stress far above the pressure of its patch.
  ImportedFigures beam = usual();
  beam.stress = 2e7;
  CHECK(import_warnings(beam).empty());
  // Without stress or loads nothing is said of them.
  ImportedFigures bare = usual();
  bare.stress = 0;
  bare.load.reset();
  bare.patch_pressure = 0;
  CHECK(import_warnings(bare).empty());
  CHECK_THAT(figures_text(bare), Contains("von Mises stress not given, load not given"));
}

TEST_CASE("the figures of an imported body are those of its sites at full load",
          "[pipeline][import]") {
  const ReducedBody body = test::pressed_ball(0.05, 0.01, 1);
  const ImportedFigures figures = figures_of(body, true);
  CHECK(figures.size.maxCoeff() == Approx(0.1).epsilon(0.01));
  CHECK(figures.displacement >= 0.0099);  // the press itself, in single precision
  CHECK(figures.stress == body.largest_von_mises);
  CHECK(figures.load == body.sites.front().full_load);
  CHECK(figures.patch_pressure > 0.0);
  CHECK_FALSE(figures_of(body, false).load.has_value());
  CHECK_THAT(figures_text(figures), Contains("displacement up to 1") && Contains(" mm"));
  // The same of a body with further parameters, which are at their defaults.
  CHECK(figures_of(test::with_further(body), true).displacement > 0.0);
}

}  // namespace
}  // namespace palpable
