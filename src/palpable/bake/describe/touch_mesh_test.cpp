#include "palpable/bake/describe/touch_mesh.h"

#include "palpable/common/geometry/surface_mesh.h"
#include "tests/support/test.h"

namespace palpable {
namespace {

TEST_CASE("a coarser mesh for touch is made where the skin is fine, or where it is asked for",
          "[describe][touch]") {
  const SurfaceMesh coarse = sphere_surface({0, 0, 0}, 0.05, 4);  // 2,562 vertices
  const SurfaceMesh fine = sphere_surface({0, 0, 0}, 0.05, 5);    // 10,242
  BodyDescription body;
  for (const char* file : {"ball.stl", "ball.msh"}) {
    INFO(file);
    body.shape.file = file;
    body.touch = {};
    CHECK_FALSE(touch_edge(body, coarse));
    REQUIRE(touch_edge(body, fine));
    // A skin of kCoarseSkin vertices with that edge covers the ball.
    const double ratio = *touch_edge(body, fine) / mean_edge_length(fine);
    CHECK(fine.vertex_count() / (ratio * ratio) == Approx(kCoarseSkin));
    body.touch.edge = 0.02;
    CHECK(touch_edge(body, coarse) == 0.02);
    CHECK(touch_edge(body, fine) == 0.02);
    // A given volume mesh is used as it is where tables are requested explicitly.
    body.touch = {.by_default = false};
    CHECK(touch_edge(body, fine).has_value() == !body.shape.is_volume());
    body.touch.edge = 0.02;
    CHECK(touch_edge(body, fine) == 0.02);
  }
}

}  // namespace
}  // namespace palpable
