#include "bench/bake/touch_study.h"

#include "palpable/touch_bake/touch_maker.h"
#include "tests/support/standing_rubber.h"
#include "tests/support/test.h"

#include <algorithm>
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
      std::string why;
      for (const TouchDifference& d :
           compare_touch(solver, skin, nullptr, touch, tables.point_spacing, scene, 0.005, why)) {
        all.push_back(d);
      }
      INFO(why);
      CHECK(why.empty());
    }
    return all;
  }
};

TEST_CASE("the tables of touch answer as full contact does, the linear ones less well",
          "[bench][touch][long]") {
  Touched body;
  std::vector<double> nonlinear, linear;
  for (const PressingThing thing : {PressingThing::kFinger, PressingThing::kRim}) {
    INFO(name_of(thing));
    for (const TouchDifference& d : body.compare(thing, true)) {
      INFO(1e3 * d.depth << " mm");
      // A finger slips along the block's edge here, a little earlier than in the truth.
      CHECK(d.displacement < tolerance(0.08, "of the one that slips; 0.03 of the others"));
      CHECK(d.force < tolerance(0.05, "likewise"));
      CHECK(d.penetration < 2e-4);
      nonlinear.push_back(d.displacement);
    }
    for (const TouchDifference& d : body.compare(thing, false)) linear.push_back(d.displacement);
  }
  REQUIRE(nonlinear.size() == 8);
  REQUIRE(linear.size() == 8);
  std::sort(nonlinear.begin(), nonlinear.end());
  std::sort(linear.begin(), linear.end());
  CHECK(nonlinear[6] < tolerance(0.04, "0.036: 64 modes of a coarse block, 20 mm apart"));
  CHECK(linear[4] > 1.5 * nonlinear[4]);
  const Compliance compliance(body.tables.compliance);
  for (const double error : compliance_errors(body.skin, compliance, 10, 1)) {
    CHECK(error < tolerance(3e-3, "32 of up to 81 columns of a cluster; 16 bits"));
  }
}

TEST_CASE("things touch a body when they are brought to it, and enter it with their depth",
          "[bench][touch]") {
  const SolidModel model = block();
  const SkinResponse skin(model, boundary_of(model.mesh));
  const SurfaceMesh& surface = skin.skin();
  for (int k = 0; k < kPressingThings; ++k) {
    const auto thing = static_cast<PressingThing>(k);
    INFO(name_of(thing));
    const auto scenes = touch_scenes(skin, thing, 2, 9);
    REQUIRE(scenes.size() == 2);
    for (const TouchScene& scene : scenes) {
      const auto nearest = [&](double depth) {
        const ObstacleGaps gaps(obstacle_at(scene, depth));
        double least = 1;
        for (int v = 0; v < surface.vertex_count(); ++v) {
          for (int part = 0; part < gaps.part_count(); ++part) {
            least = std::min(least, gaps.distance(part, surface.vertices.col(v)));
          }
        }
        return least;
      };
      CHECK(nearest(0) > -1e-6);
      CHECK(nearest(0) < 0.004);  // it touches a vertex or the middle of a triangle, edges 6 mm
      CHECK(nearest(0.004) < nearest(0));
    }
  }
  const auto again = touch_scenes(skin, PressingThing::kRim, 2, 9);
  const auto first = touch_scenes(skin, PressingThing::kRim, 2, 9);
  CHECK(again[1].touching.capsules[0].a == first[1].touching.capsules[0].a);
}

}  // namespace
}  // namespace palpable
