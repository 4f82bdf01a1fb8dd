#include "palpable/live/events/event_lines.h"

#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <nlohmann/json.hpp>

#include <limits>
#include <numbers>
#include <string>
#include <vector>

namespace palpable {
namespace {

using nlohmann::json;

// Two bodies; the second is rotated by a quarter turn about Z and displaced.
std::vector<EventBody> two_bodies() {
  EventBody upper{.name = "up \"per\"", .vertices = 7, .triangles = 10};
  upper.low = {-1, -2, -3};
  upper.high = {4, 5, 6};
  EventBody lower{.name = "lower", .vertices = 3, .triangles = 1};
  lower.world_from_body.translation() = Eigen::Vector3d(1, 2, 3);
  lower.world_from_body.linear() =
      Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return {upper, lower};
}

Scene some_scene() {
  Scene scene;
  scene.number = 7;
  scene.time = 0.2333333;
  scene.bodies.resize(2);
  scene.bodies[0].camera_from_body.translation() = Eigen::Vector3d(0.125, 0, 0.5);
  scene.bodies[1].stated_error = StatedError{.displacement = 0.01, .von_mises = 0.02};
  scene.camera.state = TrackState::kTracking;
  scene.camera.world_from_camera.translation() = Eigen::Vector3d(0, 0, -0.25);
  Touch touch;
  touch.body = 1;
  touch.force = 2;
  touch.press_depth = 0.0012345;
  touch.point_in_body = {0.5, 0, 0};
  touch.direction = {0, -1, 0};
  touch.area = 0.000123456;
  touch.assumed = 0.25;
  touch.unseen_for = 0.5;
  scene.touches.push_back(touch);
  return scene;
}

json parsed(std::string_view line) {
  REQUIRE(line.ends_with("}\n"));
  REQUIRE(line.find('\n') == line.size() - 1);
  return json::parse(line);
}

TEST_CASE("the first line says the version, units, frames and bodies", "[events]") {
  const json hello = parsed(hello_line(two_bodies()));
  CHECK(hello["type"] == "hello");
  CHECK(hello["version"] == 2);
  CHECK(hello["units"]["force"] == "N");
  CHECK(hello["frames"]["world"] == "the camera of the first frame");
  REQUIRE(hello["bodies"].size() == 2);
  CHECK(hello["bodies"][0]["name"] == "up \"per\"");
  CHECK(hello["bodies"][0]["vertices"] == 7);
  CHECK(hello["bodies"][0]["triangles"] == 10);
  CHECK(hello["bodies"][0]["low"] == json{-1.0, -2.0, -3.0});
  CHECK(hello["bodies"][0]["high"] == json{4.0, 5.0, 6.0});
  CHECK(hello["bodies"][1]["world_from_body"][3] == 1.0);
  CHECK(hello["bodies"][1]["world_from_body"][1] == -1.0);  // row by row
}

TEST_CASE("a tick's line has the touches of each body, as a frame's", "[events]") {
  EventLines lines(two_bodies());
  const Scene scene = some_scene();
  const json frame = parsed(lines.line_of(scene));
  const json tick = parsed(lines.tick_line(7, 3, 0.2363333, scene.touches));
  CHECK(tick["type"] == "tick");
  CHECK(tick["frame"] == 7);
  CHECK(tick["tick"] == 3);
  CHECK(tick["time"] == 0.236333);
  REQUIRE(tick["bodies"].size() == 2);
  for (int k = 0; k < 2; ++k) {
    CHECK(tick["bodies"][k]["name"] == frame["bodies"][k]["name"]);
    CHECK(tick["bodies"][k]["touches"] == frame["bodies"][k]["touches"]);
  }
  CHECK(tick["bodies"][1]["touches"].size() == 1);
}

TEST_CASE("a frame's line has poses, touches in both frames, and stated errors", "[events]") {
  EventLines lines(two_bodies());
  const json frame = parsed(lines.line_of(some_scene()));
  CHECK(frame["type"] == "frame");
  CHECK(frame["frame"] == 7);
  CHECK(frame["time"] == 0.233333);
  CHECK(frame["camera"]["state"] == "tracking");
  CHECK(frame["camera"]["new_world"] == false);
  CHECK(frame["camera"]["world_from_camera"][11] == -0.25);
  const json& upper = frame["bodies"][0];
  CHECK(upper["name"] == "up \"per\"");
  CHECK(upper["camera_from_body"][3] == 0.125);
  CHECK(upper["touches"].empty());
  CHECK_FALSE(upper.contains("displacement_error"));
  const json& lower = frame["bodies"][1];
  CHECK(lower["world_from_body"][7] == 2.0);
  CHECK(lower["displacement_error"] == 0.01);
  CHECK(lower["stress_error"] == 0.02);
  REQUIRE(lower["touches"].size() == 1);
  const json& touch = lower["touches"][0];
  CHECK(touch["point"] == json{0.5, 0.0, 0.0});
  CHECK(touch["force"] == json{0.0, -2.0, 0.0});
  CHECK(touch["normal"] == json{0.0, 1.0, 0.0});
  CHECK_FALSE(touch.contains("friction"));
  CHECK(touch["press_depth"] == 0.0012345);
  CHECK(touch["area"] == 0.000123456);
  CHECK(touch["assumed"] == 0.25);
  CHECK(touch["unseen_for"] == 0.5);
  CHECK_FALSE(touch.contains("by"));
  CHECK_FALSE(touch.contains("site"));
  // A quarter turn about Z maps X to Y and Y to -X.
  CHECK(touch["world"]["point"] == json{1.0, 2.5, 3.0});
  CHECK(touch["world"]["force"] == json{2.0, 0.0, 0.0});
}

TEST_CASE("poses are row by row and vectors x y z, in a world that is turned about three axes",
          "[events]") {
  std::vector<EventBody> bodies = two_bodies();
  Eigen::Matrix3d R;  // a cyclic turn: X to Y, Y to Z, Z to X
  R << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  bodies[1].world_from_body.linear() = R;
  Scene scene = some_scene();
  scene.bodies[1].camera_from_body.linear() = R;
  scene.bodies[1].camera_from_body.translation() = Eigen::Vector3d(4, 5, 6);
  scene.touches[0].point_in_body = {0.5, 0.25, 0.125};
  scene.touches[0].direction = Eigen::Vector3d(2, -3, 6) / 7;
  scene.touches[0].force = 14;
  EventLines lines(bodies);
  const json frame = parsed(lines.line_of(scene));
  const json& body = frame["bodies"][1];
  CHECK(body["camera_from_body"] ==
        json{0.0, 0.0, 1.0, 4.0, 1.0, 0.0, 0.0, 5.0, 0.0, 1.0, 0.0, 6.0, 0.0, 0.0, 0.0, 1.0});
  CHECK(body["world_from_body"] ==
        json{0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 2.0, 0.0, 1.0, 0.0, 3.0, 0.0, 0.0, 0.0, 1.0});
  const json& touch = body["touches"][0];
  CHECK(touch["point"] == json{0.5, 0.25, 0.125});
  const auto near = [](const json& read, const Eigen::Vector3d& wanted) {
    const Eigen::Vector3d v(read[0].get<double>(), read[1].get<double>(), read[2].get<double>());
    INFO(v.transpose());
    return (v - wanted).norm() < 1e-5;  // floats, and the digits of the line
  };
  CHECK(near(touch["force"], {4, -6, 12}));
  CHECK(near(touch["world"]["point"], {1.125, 2.5, 3.25}));
  CHECK(near(touch["world"]["force"], {12, 4, -6}));
}

TEST_CASE("a touch names its site, or the body that presses", "[events]") {
  EventLines lines(two_bodies());
  Scene scene = some_scene();
  scene.touches[0].by = 0;
  scene.touches.push_back({4, 0.5, 1.25, 0.003, {0.01, 0.02, 0.03}, {0, -1, 0}});
  const json frame = parsed(lines.line_of(scene));
  CHECK(frame["bodies"][1]["touches"][0]["by"] == "up \"per\"");
  const json& at_site = frame["bodies"][0]["touches"][0];
  CHECK(at_site["site"] == 4);
  CHECK(at_site["level"] == 0.5);
  CHECK_FALSE(at_site.contains("area"));
  CHECK_FALSE(at_site.contains("assumed"));
}

TEST_CASE("the pose of a lost camera, and what is no number, are null", "[events]") {
  EventLines lines(two_bodies());
  Scene scene = some_scene();
  scene.camera.state = TrackState::kLost;
  scene.camera.new_world = true;
  scene.touches[0].force = std::numeric_limits<double>::quiet_NaN();
  scene.touches[0].area = std::numeric_limits<double>::infinity();
  scene.bodies[0].camera_from_body.translation().x() = std::numeric_limits<double>::quiet_NaN();
  const json frame = parsed(lines.line_of(scene));
  CHECK(frame["camera"]["state"] == "lost");
  CHECK(frame["camera"]["world_from_camera"].is_null());
  CHECK(frame["camera"]["new_world"] == true);
  CHECK(frame["bodies"][0]["camera_from_body"].is_null());
  CHECK(frame["bodies"][1]["touches"][0]["force"][1].is_null());
  CHECK(frame["bodies"][1]["touches"][0]["area"].is_null());
}

TEST_CASE("after the first touches a frame's line takes no memory", "[events][allocation]") {
  EventLines lines(two_bodies());
  Scene scene = some_scene();
  scene.touches.resize(5, scene.touches[0]);
  std::ignore = lines.line_of(scene);
  scene.touches.pop_back();
  CHECK(test::allocations_during([&] { std::ignore = lines.line_of(scene); }) == 0);
}

}  // namespace
}  // namespace palpable
