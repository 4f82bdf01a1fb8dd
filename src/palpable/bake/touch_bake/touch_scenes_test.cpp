#include "palpable/bake/touch_bake/touch_scenes.h"

#include "tests/support/standing_rubber.h"
#include "tests/support/test.h"

#include <algorithm>

namespace palpable {
namespace {

TEST_CASE("things just touch a body at depth 0 and are inside it at larger depths",
          "[touch_bake]") {
  const SolidModel model =
      test::standing_rubber(box_tets({-0.03, -0.025, 0}, {0.03, 0.025, 0.04}, 10, 8, 7));
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
          least = std::min(least, gaps.distance(surface.vertices.col(v)));
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
