#include "palpable/live/player/body_place.h"

#include "tests/support/bodies.h"
#include "tests/support/test.h"

#include <utility>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Eigen::Vector3d;
using test::tolerance;

LiveBody ball(const std::string& name, const BodyPlace& place = {}) {
  return {TouchableBody(test::pressed_ball()), name, place};
}

Rigid3 shift(double x, double y, double z) {
  Rigid3 pose = Rigid3::Identity();
  pose.translation() = Vector3d(x, y, z);
  return pose;
}

TEST_CASE("bodies stand at their anchors, beside each other or where they say", "[player][scene]") {
  std::vector<LiveBody> bodies;
  bodies.push_back(ball("first", {.anchor_from_body = shift(0.1, 0, 0)}));
  bodies.push_back(ball("second", {.beside = 0, .anchor_from_body = shift(0, 0.2, 0)}));
  bodies.push_back(ball("third", {.anchor = Anchor::kPlane}));
  bodies.push_back(ball("fourth", {.anchor = Anchor::kPlace, .place = shift(9, 9, 9)}));
  std::vector<Anchor> queried;
  const std::vector<PlacedBody> all = placed(std::move(bodies), Anchor::kPlace, [&](Anchor anchor) {
    queried.push_back(anchor);
    return anchor == Anchor::kPlane ? shift(0, 0, 2) : shift(0, 0, 1);
  });
  REQUIRE(all.size() == 4);
  CHECK(all[0].world_from_body.translation() == Vector3d(0.1, 0, 1));
  CHECK(all[1].world_from_body.translation() == Vector3d(0.1, 0.2, 1));
  CHECK(all[2].world_from_body.translation() == Vector3d(0, 0, 2));
  CHECK(all[3].world_from_body.translation() == Vector3d(9, 9, 9));
  CHECK(queried == std::vector<Anchor>{Anchor::kPlace, Anchor::kPlane});
}

TEST_CASE("a body that stands in another is told of by name, one that stands on it is not",
          "[player][scene]") {
  const auto two = [](const Rigid3& second) {
    std::vector<LiveBody> bodies;
    bodies.push_back(ball("egg"));
    bodies.push_back(ball("cup", {.anchor_from_body = second}));
    return placed(std::move(bodies), Anchor::kPlace, [](Anchor) { return shift(0, 0, 1); });
  };
  CHECK_FALSE(overlap_of(two(shift(0.11, 0, 0))));
  CHECK_FALSE(overlap_of(two(shift(0, 0, 0.1))));  // 50 mm balls, one on top of the other
  const auto said = overlap_of(two(shift(0, 0, 0.09)));
  REQUIRE(said);
  CHECK_THAT(*said, Catch::Contains("'cup' stands in 'egg'") && Catch::Contains("10.0 mm"));
  CHECK(overlap_of(two(shift(0, 0, 0))));  // both in the same place
}

TEST_CASE("a body outside of the camera's picture is reported, with its position",
          "[player][place]") {
  const PinholeCamera camera{1280, 720, 640, 640, 639.5, 359.5};  // its view is 2 m wide at 1 m
  const SurfaceMesh body = sphere_surface({0, 0, 0.04}, 0.04, 1);
  const auto warning = [&](double x, double y, double z) {
    Rigid3 pose = Rigid3::Identity();
    pose.translation() = Eigen::Vector3d(x, y, z);
    return outside_of_view(body, pose, camera);
  };
  CHECK_FALSE(warning(0, 0, 1));
  CHECK_FALSE(warning(1.02, 0, 1));  // its left side is in the picture
  CHECK(warning(1.1, 0, 1));
  CHECK(warning(0, -0.7, 1));
  CHECK_THAT(warning(0, 0, -1).value(), Contains("-1 m forward"));
}

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
