#include "palpable/bake/describe/touches_between.h"

#include "palpable/bake/describe/contact_sites.h"
#include "tests/support/test.h"

#include <algorithm>
#include <vector>

namespace palpable {
namespace {

TEST_CASE("touches lie between sites, evenly from the list, and are none themselves",
          "[describe][between]") {
  const SurfaceMesh skin = sphere_surface({0, 0, 0}, 1, 3);
  // Three sites within an eighth of the ball around its first vertex.
  const auto neighbours = vertex_neighbours(skin);
  const std::vector<int> near = graph_patch(neighbours, 0, 3);
  const std::vector<int> sites{near[0], near[near.size() / 2], near.back()};
  std::vector<int> all(skin.vertex_count());
  for (std::size_t v = 0; v < all.size(); ++v) all[v] = static_cast<int>(v);
  const auto distance = [&](int a, int b) {
    return (skin.vertices.col(a) - skin.vertices.col(b)).norm();
  };
  double farthest = 0;
  for (const int a : sites) {
    double nearest = 10;
    for (const int b : sites) {
      if (a != b) nearest = std::min(nearest, distance(a, b));
    }
    farthest = std::max(farthest, nearest);
  }
  const std::vector<int> touches = touches_between(skin, sites, all, 100000);
  CHECK((touches.size() > 3 && touches.size() < all.size() / 2));
  for (const int v : all) {
    double nearest = 10;
    for (const int s : sites) nearest = std::min(nearest, distance(v, s));
    const bool listed = std::find(touches.begin(), touches.end(), v) != touches.end();
    CHECK(listed == (nearest > 0 && nearest <= farthest));
  }
  const std::vector<int> some = touches_between(skin, sites, all, 5);
  REQUIRE(some.size() == 5);
  for (std::size_t i = 0; i < 5; ++i) CHECK(some[i] == touches[i * touches.size() / 5]);
  CHECK(touches_between(skin, {4}, all, 5).empty());
}

}  // namespace
}  // namespace palpable
