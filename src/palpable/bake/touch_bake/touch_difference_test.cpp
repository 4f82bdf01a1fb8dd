#include "palpable/bake/touch_bake/touch_difference.h"

#include "palpable/bake/touch_bake/held_out_maker.h"
#include "palpable/bake/touch_bake/touch_maker.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/standing_rubber.h"
#include "tests/support/test.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace palpable {
namespace {

using test::tolerance;

// 60 x 50 x 40 mm.
SolidModel block() {
  return test::standing_rubber(box_tets({-0.03, -0.025, 0}, {0.03, 0.025, 0.04}, 10, 8, 7));
}

struct Touched {
  SolidModel model = block();
  EquilibriumSolver solver{model};
  SkinResponse skin{model, boundary_of(model.mesh)};
  TouchTables tables;

  Touched() {
    TouchBakeSettings settings;
    settings.point_spacing = 0.003;
    settings.regions.spacing = 0.020;
    settings.regions.reach = 0.024;
    settings.regions.loads = 80;
    settings.regions.modes = 64;
    settings.cross.modes = 64;
    settings.cross.places = 40;
    settings.cross.pairs = 100;
    settings.threads = 2;
    tables = make_touch_tables(skin, settings);
  }

  [[nodiscard]] std::vector<TouchDifference> compare(PressingThing thing, bool nonlinear) {
    TouchSettings settings;
    settings.nonlinear = nonlinear;
    TouchSolver touch(skin.skin(), skin.fixed(), tables, settings);
    std::vector<TouchDifference> all;
    for (const TouchScene& scene : touch_scenes(skin, thing, 2, 5)) {
      CHECK(compare_touch(solver, skin, nullptr, touch, tables.point_spacing, scene,
                          std::array{0.0025, 0.005},
                          [&](const TouchDifference& d) { all.push_back(d); }) == "");
    }
    return all;
  }
};

TEST_CASE("touch tables agree with full contact, and better than the linear table alone",
          "[touch_bake][long]") {
  Touched body;
  std::vector<double> nonlinear, linear;
  for (const PressingThing thing : {PressingThing::kFinger, PressingThing::kRim}) {
    INFO(name_of(thing));
    for (const TouchDifference& d : body.compare(thing, true)) {
      INFO(1e3 * d.touch.depth << " mm");
      // In this scene a finger slips along the block's edge, a little earlier than in the
      // full-order solution.
      CHECK(d.touch.displacement < tolerance(0.08, "of the one that slips; 0.03 of the others"));
      CHECK(d.touch.force < tolerance(0.05, "likewise"));
      CHECK(d.report.penetration < 2e-4);
      CHECK((d.report.indicators.beyond > 0.002 && d.report.indicators.beyond < 0.3));
      CHECK(d.touch.unscaled_error == unscaled_error(d.report.indicators));
      nonlinear.push_back(d.touch.displacement);
    }
    for (const TouchDifference& d : body.compare(thing, false)) {
      CHECK(d.report.indicators.beyond == 0.0);
      linear.push_back(d.touch.displacement);
    }
  }
  REQUIRE(nonlinear.size() == 8);
  REQUIRE(linear.size() == 8);
  std::sort(nonlinear.begin(), nonlinear.end());
  std::sort(linear.begin(), linear.end());
  CHECK(nonlinear[6] < tolerance(0.04, "0.036: 64 modes of a coarse block, 20 mm apart"));
  CHECK(linear[4] > 1.5 * nonlinear[4]);
}

TEST_CASE("tables with friction agree with full contact with the same friction",
          "[touch_bake][friction][long]") {
  Touched body;
  TouchSettings settings;
  settings.friction = 0.5;
  TouchSolver rubs(body.skin.skin(), body.skin.fixed(), body.tables, settings);
  settings.friction = 0;
  TouchSolver slides(body.skin.skin(), body.skin.fixed(), body.tables, settings);
  std::vector<double> with, without;
  for (const PressingThing thing : {PressingThing::kFinger, PressingThing::kPalm}) {
    for (const TouchScene& scene : touch_scenes(body.skin, thing, 2, 5)) {
      for (TouchSolver* touch : {&rubs, &slides}) {
        std::vector<double>& errors = touch == &rubs ? with : without;
        CHECK(compare_drag(body.solver, body.skin, nullptr, *touch, body.tables.point_spacing,
                           scene, 0.003, std::array{0.002},
                           [&](const TouchDifference& d) {
                             CHECK(d.dragged == 0.002);
                             CHECK(d.report.friction_residual < tolerance(1e-5, "m"));
                             errors.push_back(d.touch.displacement);
                           },
                           {.friction = 0.5}) == "");
      }
    }
  }
  REQUIRE(with.size() == without.size());
  REQUIRE(with.size() >= 3);
  std::sort(with.begin(), with.end());
  std::sort(without.begin(), without.end());
  CHECK(with[with.size() / 2] < tolerance(0.1, "64 modes of a coarse block, and a frame's slide"));
  CHECK(without[without.size() / 2] > 2 * with[with.size() / 2]);
}

TEST_CASE("held-out touches are the same on any number of threads, and solved once",
          "[touch_bake][long]") {
  const test::ScratchFolder folder("held_out");
  const Touched body;
  HeldOutSettings settings{.count = 4, .least_depth = 0.001, .largest_depth = 0.003, .threads = 2};
  const auto make = [&](const TouchStore* store, const Progress& progress = {}) {
    TouchKeys keys;
    keys.held_out = held_out_key(keys, body.tables, settings);
    return make_held_out(body.solver, body.skin, nullptr, body.tables, settings, progress, keys,
                         store);
  };
  const TouchStore store(folder / "touch");
  const std::vector<HeldOutTouch> touches = make(&store);
  REQUIRE(touches.size() == 4);
  CHECK(touches[3].thing == PressingThing::kFinger);
  CHECK(trouble_of(touches).empty());
  for (const HeldOutTouch& touch : touches) {
    CHECK((touch.depth >= 0.001 && touch.depth <= 0.003));
    CHECK(touch.displacement < tolerance(0.08, "as above"));
  }
  int solved = 0;
  const auto count = [&](const ProgressReport&) { ++solved; };
  const std::vector<HeldOutTouch> kept = make(&store, count);
  CHECK(solved == 0);
  settings.threads = 1;
  for (const HeldOutTouch& touch : kept) CHECK(touch.unscaled_error.value() > 0);
  const std::vector<HeldOutTouch> alone = make(nullptr, count);
  CHECK(solved == 4);
  REQUIRE((kept.size() == 4 && alone.size() == 4));
  for (std::size_t k = 0; k < 4; ++k) {
    for (double HeldOutTouch::*value : kHeldOutValues) {
      CHECK(kept[k].*value == touches[k].*value);
      CHECK(alone[k].*value == touches[k].*value);
    }
  }
  settings.count = 3;
  CHECK(make(&store).size() == 3);
}

TEST_CASE("a press is solved once more with half the steps, on request",
          "[touch_bake][friction][long]") {
  const SolidModel model = block();
  const EquilibriumSolver solver(model);
  const SkinResponse skin(model, boundary_of(model.mesh));
  TouchBakeSettings linear;
  linear.point_spacing = 0.003;
  linear.regions.most = 0;
  linear.threads = 2;
  const TouchTables tables = make_touch_tables(skin, linear);
  TouchSolver touch(skin.skin(), skin.fixed(), tables, {.friction = 0.5});
  const TouchScene scene = touch_scenes(skin, PressingThing::kFinger, 1, 5).front();
  const auto press = [&](const ComparisonSettings& settings) {
    std::optional<TouchDifference> last;
    CHECK(compare_touch(
              solver, skin, nullptr, touch, tables.point_spacing, scene, std::array{0.0025},
              [&](const TouchDifference& d) { last = d; }, settings) == "");
    return last.value();
  };
  CHECK_FALSE(press({.friction = 0.5}).half_step);
  const TouchDifference rubbed = press({.friction = 0.5, .halves_steps = true});
  REQUIRE(rubbed.half_step);
  CHECK(*rubbed.half_step > 0);  // it was another solution
  CHECK(*rubbed.half_step < tolerance(0.01, "of four steps a frame: one root"));
  // Without friction there is one solution, of whatever path.
  const TouchDifference slid = press({.halves_steps = true});
  REQUIRE(slid.half_step);
  CHECK(*slid.half_step < tolerance(1e-3, "both converged"));
}

}  // namespace
}  // namespace palpable
