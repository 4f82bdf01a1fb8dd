#include "palpable/desk/script/beams.h"

#include "palpable/common/base/error.h"
#include "palpable/desk/script/contact_truth.h"
#include "tests/support/test.h"

#include <vector>

namespace palpable {
namespace {

using Eigen::Vector3d;
using test::tolerance;

// A bar of 0.20 x 0.05 x 0.025 m round the axis of its frame, with sites on its top except near the
// support.
DeskBody bar() {
  DeskBody body;
  constexpr int kX = 20, kY = 5;
  const auto index = [](int i, int j, int top) { return (i * (kY + 1) + j) * 2 + top; };
  body.surface.vertices.resize(3, (kX + 1) * (kY + 1) * 2);
  std::vector<Eigen::Vector3i> triangles;
  for (int i = 0; i <= kX; ++i) {
    for (int j = 0; j <= kY; ++j) {
      for (int top = 0; top < 2; ++top) {
        body.surface.vertices.col(index(i, j, top)) =
            Vector3d(-0.1 + 0.01 * i, -0.025 + 0.01 * j, 0.025 * top);
      }
      if (i > 3) body.site_vertices.push_back(index(i, j, 1));
      if (i == kX || j == kY) continue;
      triangles.emplace_back(index(i, j, 1), index(i + 1, j, 1), index(i + 1, j + 1, 1));
      triangles.emplace_back(index(i, j, 1), index(i + 1, j + 1, 1), index(i, j + 1, 1));
      triangles.emplace_back(index(i, j, 0), index(i + 1, j + 1, 0), index(i + 1, j, 0));
      triangles.emplace_back(index(i, j, 0), index(i, j + 1, 0), index(i + 1, j + 1, 0));
    }
  }
  body.surface.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    body.surface.triangles.col(static_cast<Eigen::Index>(t)) = triangles[t];
  }
  body.directions = (-Vector3d::UnitZ()).replicate(1, std::ssize(body.site_vertices));
  return body;
}

std::vector<PlacedDeskBody> stack(double gap) {
  std::vector<PlacedDeskBody> bodies{{bar()}, {bar()}};
  bodies[0].scene_from_body.translation().z() = 0.04;
  bodies[1].scene_from_body.translation().z() = 0.04 + 0.025 + gap;
  return bodies;
}

TEST_CASE("a finger presses the upper beam onto the lower one, and nothing else", "[script]") {
  const std::vector<PlacedDeskBody> bodies = stack(0.010);
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Sequence s = plan_beams(bodies, kBeamsFrames, seed);
    CHECK(s.frames == kBeamsFrames);
    REQUIRE(s.touches.size() >= 2);
    const Rigid3 desk_from_scene = s.desk_from_body * bodies[0].scene_from_body.inverse();
    const SurfacePoints lower =
        transformed(sample_surface(bodies[0].body.surface, 0.004), s.desk_from_body);
    const SurfacePoints upper = transformed(sample_surface(bodies[1].body.surface, 0.004),
                                            desk_from_scene * bodies[1].scene_from_body);
    for (int frame = 0; frame < s.frames; ++frame) {
      const std::vector<Capsule> hand = shapes_of(s.movers(frame).capsules);
      CHECK_FALSE(touches(hand, lower.points));
      if (frame < kFramesWithoutHand) CHECK(hand.empty());
      bool planned = false;
      for (const PlannedTouch& touch : s.touches) {
        planned |= frame >= touch.frames.first && frame <= touch.frames.last;
      }
      if (!planned) CHECK_FALSE(touches(hand, upper.points));
    }
    for (const PlannedTouch& touch : s.touches) {
      CHECK(touch.depth > 0.0065);  // the free end moves down by more than the gap of 10 mm
      CHECK(touch.depth < 0.020);
      CHECK(touch.first_touch.x() > 0.03);  // the free end is to the right
      if (touch.frames.last >= s.frames) continue;
      double deepest = 0;
      for (int frame = touch.frames.first; frame <= touch.frames.last; ++frame) {
        const PressTruth truth = press_truth(shapes_of(s.movers(frame).capsules), upper);
        deepest = std::max(deepest, truth.depth);
      }
      CHECK(deepest == Approx(touch.depth).margin(tolerance(1e-3, "m: tremor, points 4 mm apart")));
    }
  }
}

TEST_CASE("scenes other than two beams above each other are refused", "[script][errors]") {
  CHECK_THROWS_WITH(plan_beams(stack(0.2), 100, 1), Catch::Contains("gap of 2 to 60 mm"));
  CHECK_THROWS_WITH(plan_beams(std::vector<PlacedDeskBody>{{bar()}}, 100, 1),
                    Catch::Contains("two beams"));
}

}  // namespace
}  // namespace palpable
