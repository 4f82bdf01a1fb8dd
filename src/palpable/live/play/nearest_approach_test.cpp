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
  CHECK_THAT(text, Contains("thing 7 came no nearer than 50.") &&
                       Contains(" mm to a vertex of ball, at 1 s\n"));
  CHECK_THAT(text, Contains("thing 8 came no nearer than 44"));
  CHECK(text.find("thing 7") < text.find("thing 8"));
  CHECK_THAT(text, Contains(" 0.050 m farther along X, Y, Z: --place"));
}

TEST_CASE("the way has a direction", "[play][things]") {
  const auto way = [](const Eigen::Vector3d& thing) {
    NearestApproach approach(ball_at({0, 0, 0.2}));
    approach.add(line_of(0, 1, thing));
    return approach.text();
  };
  // Below the ball, whose lowest vertex is at Z = 0.2.
  CHECK_THAT(way({0, 0, 0.14}), Contains(" -0.050 m farther along X, Y, Z: --place"));
  // Beside its middle, whose radius is 50 mm: its vertices are not exactly there.
  const std::string left = way({-0.16, 0, 0.25}), right = way({0.16, 0, 0.25});
  CHECK_THAT(left, Contains("stood -0.1") || Contains("stood -0.09"));
  CHECK_THAT(right, Contains("stood 0.1") || Contains("stood 0.09"));
}

TEST_CASE("a capsule is measured again only where it may have come nearer", "[play][things]") {
  NearestApproach approach(ball_at({0, 0, 0.2}));
  approach.add(line_of(0, 1, {0, 0, 0.36}));
  CHECK(approach.measured() == 1);
  for (int k = 0; k < 100; ++k) approach.add(line_of(1 + k, 1, {0.0005 * (k % 2), 0, 0.36}));
  CHECK(approach.measured() == 1);  // it moves by half a millimetre
  for (int k = 0; k < 100; ++k) approach.add(line_of(200 + k, 1, {0, 0, 0.45 + 0.001 * k}));
  CHECK(approach.measured() == 1);  // it goes: the box of the body is farther away than before
  approach.add(line_of(400, 1, {0, 0, 0.35}));
  CHECK(approach.measured() == 2);
  CHECK_THAT(approach.text(), Contains("no nearer than 40.") && Contains("at 400 s"));
}

TEST_CASE("of thousands of things some are told apart, and the nearest is found nevertheless",
          "[play][things]") {
  NearestApproach approach(ball_at({0, 0, 0.2}));
  for (int k = 0; k < 3000; ++k) approach.add(line_of(k, k, {0, 0, k == 2500 ? 0.34 : 0.5}));
  CHECK_THAT(approach.text(), Contains("60 more things stayed farther away") &&
                                  Contains("further things, beyond 64, came no nearer than 30.") &&
                                  Contains(" 0.030 m farther along X, Y, Z"));
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
