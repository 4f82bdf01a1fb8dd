#include "palpable/live/player/body_in_view.h"

#include "tests/support/test.h"

namespace palpable {
namespace {

using Catch::Matchers::Contains;

TEST_CASE("a body larger than what the camera sees is said, with both sizes", "[player][size]") {
  const PinholeCamera camera{1280, 720, 640, 640, 639.5, 359.5};  // its view is 2 m wide at 1 m
  Rigid3 pose = Rigid3::Identity();
  pose.translation().z() = 0.5;
  const auto said = [&](double scale) {
    SurfaceMesh body = sphere_surface({0, 0, 0.04}, 0.04, 1);
    body.vertices *= scale;
    return larger_than_view(body, pose, camera);
  };
  CHECK_FALSE(said(1));
  CHECK_FALSE(said(12.4));  // 0.99 m wide in a view of 1 m
  CHECK(said(12.7));
  CHECK_THAT(said(1000).value(),
             Contains("the body is 8") &&
                 Contains(" m, larger than what the camera sees where it stands (1 x 0.562 m at "
                          "0.5 m)"));
  pose.translation().z() = -0.5;
  CHECK_FALSE(said(1000));
}

}  // namespace
}  // namespace palpable
