#include "palpable/live/play/nearest_approach.h"

#include "tests/support/dented_sphere.h"
#include "tests/support/some_touch_tables.h"
#include "tests/support/test.h"

#include <string>
#include <vector>

namespace palpable {
namespace {

using Catch::Matchers::Contains;

// A ball 0.1 m high that stands on the floor, moved.
std::vector<PlacedBody> ball_at(const Eigen::Vector3d& at) {
  const ReducedBody body = test::DentedSphere{}.body();
  std::vector<PlacedBody> bodies;
  Rigid3 pose = Rigid3::Identity();
  pose.translation() = at;
  bodies.push_back({TouchableBody(body, test::yielding_tables(body.surface)), pose, "ball"});
  return bodies;
}

ThingsLine line_of(double time, std::int64_t id, const Eigen::Vector3d& at) {
  return {.time = time, .things = {{id, 0, 1}}, .capsules = {{at, at, 0.01, 0.01}}};
}

TEST_CASE("of each thing the nearest approach is told, with the way that the body would have to go",
          "[play][things]") {
  NearestApproach approach(ball_at({0, 0, 0.2}));
  approach.add(line_of(0, 7, {0, 0, 0.5}));
  approach.add(line_of(1, 7, {0, 0, 0.36}));  // 50 mm above the top
  approach.add(line_of(2, 7, {0, 0, 0.4}));
  approach.add(line_of(3, 8, {0.5, 0, 0.25}));
  const std::string text = approach.text();
  CHECK_THAT(text,
             Contains("thing 7 came no nearer than 50.") && Contains(" mm to ball, at 1 s\n"));
  CHECK_THAT(text, Contains("thing 8 came no nearer than 44"));
  CHECK(text.find("thing 7") < text.find("thing 8"));
  CHECK_THAT(text, Contains("0.050 m farther along X, Y, Z: --place"));
}

TEST_CASE("a remedy fits what is wrong", "[play][things]") {
  const auto text_of_one = [](const Eigen::Vector3d& body, const Eigen::Vector3d& thing) {
    NearestApproach approach(ball_at(body));
    approach.add(line_of(0, 1, thing));
    return approach.text();
  };
  // The body stands 1 m high; the thing is there with Y up.
  CHECK_THAT(text_of_one({0, 0, 1}, {0, 1.05, 0}), Contains("--up y makes such a file"));
  CHECK_THAT(text_of_one({0, 1, 0}, {0, -0.05, 1}), Contains("was --up y given"));
  CHECK_THAT(text_of_one({0, 0, 0}, {0, 0, 120}),
             Contains("in metres") && !Contains("farther along"));
  NearestApproach nothing(ball_at({0, 0, 0}));
  nothing.add({.time = 1});
  CHECK_THAT(nothing.text(), Contains("no line has a thing"));
}

}  // namespace
}  // namespace palpable
