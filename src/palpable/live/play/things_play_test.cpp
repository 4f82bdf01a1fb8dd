#include "palpable/live/play/things_play.h"

#include "palpable/common/base/error.h"
#include "palpable/desk/clip_files/frame_records.h"
#include "palpable/live/session/things_line.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/some_touch_tables.h"
#include "tests/support/test.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using Catch::Matchers::Contains;

constexpr double kTipRadius = 0.008;  // m

// A fingertip that comes down on the top of a sphere of 0.1 m on the floor, 1 mm a line; the first
// line is 2.5 mm above it. Beside it a thing that touches nothing.
std::string finger_lines(int count, const Eigen::Vector3d& origin = Eigen::Vector3d::Zero()) {
  std::string text;
  for (int k = 0; k < count; ++k) {
    const Eigen::Vector3d tip =
        origin + Eigen::Vector3d(0, 0, 0.1 + kTipRadius + 0.0025 - 0.001 * k);
    ThingsLine line;
    line.time = 0.02 * k;
    line.things = {{42, 0, 1}, {-7, 1, 1}};
    line.capsules = {
        {tip, tip + Eigen::Vector3d(0, 0, 0.05), kTipRadius, kTipRadius},
        {origin + Eigen::Vector3d(1, 0, 0), origin + Eigen::Vector3d(1, 0, 1), 0.01, 0.01}};
    text += things_line(line);
  }
  return text;
}

ThingsSetUp set_up_ball(const fs::path& source, const Rigid3& pose = Rigid3::Identity()) {
  ThingsSetUp setup;
  setup.source = source;
  setup.bodies = {DescribedBody{.file = "sphere.palpable"}};
  const ReducedBody body = test::DentedSphere{}.body();
  setup.standing.push_back({TouchableBody(body, test::yielding_tables(body.surface)), pose});
  return setup;
}

PlayUser silent_user() {
  return {.print = [](const std::string&) {},
          .say = [](const std::string&) {},
          .progress = {},
          .begin = [] {},
          .asked_to_end = [] { return false; }};
}

PlayResult play_into(const fs::path& out, ThingsSetUp setup, int frames = -1) {
  ThingsPlay play({.out = out, .files = {.film = false}}, {}, silent_user());  // without OpenGL
  return play.play(setup, frames);
}

TEST_CASE("a hands file presses a body, and its touches are written with what pressed",
          "[play][things]") {
  const test::ScratchFolder folder("things_play");
  const fs::path file = folder / "hands.jsonl";
  test::write_bytes(file, finger_lines(8));
  const fs::path out = folder / "out";
  const PlayResult result = play_into(out, set_up_ball(file));
  CHECK(result.lost.empty());
  CHECK_THAT(result.text, Catch::StartsWith("8 frames in ") && Contains("touched in ") &&
                              !Contains("went through"));
  const std::vector<TouchesLine> touches = read_touches(out / "touches.jsonl");
  REQUIRE(touches.size() >= 3);
  CHECK(touches.front().frame >= 3);  // the first one that is inside
  CHECK(touches.back().frame == 7);
  double before = 0;
  for (const TouchesLine& line : touches) {
    INFO("frame " << line.frame);
    REQUIRE(line.touches.size() == 1);
    CHECK((line.answer == "reached" || line.answer == "later"));
    const FeltTouch& touch = line.touches.front();
    CHECK(touch.thing == 42);
    REQUIRE(touch.time);
    CHECK(std::abs(*touch.time - 0.02 * line.frame) <= test::tolerance(1e-6, "six digits"));
    CHECK(-touch.force->z() > before);
    CHECK(std::abs(touch.point->x()) < 0.01);
    before = -touch.force->z();
  }
  CHECK(result.summary["frames"].get<int>() == 8);
  CHECK(result.summary["source"].get<std::string>() == file.string());
  CHECK(fs::exists(out / "live.json"));
  for (const char* name :
       {"trajectory.txt", "pose.jsonl", "rectification.jsonl", "touch.mp4", "depth"}) {
    INFO(name);
    CHECK_FALSE(fs::exists(out / name));
  }
  CHECK(play_into({}, set_up_ball(file), 3).summary["frames"].get<int>() == 3);
}

TEST_CASE("a body is pressed where it stands in the lines' world", "[play][things]") {
  const test::ScratchFolder folder("things_play_placed");
  const Eigen::Vector3d origin(1, -2, 0.5);
  test::write_bytes(folder / "here.jsonl", finger_lines(6));
  test::write_bytes(folder / "there.jsonl", finger_lines(6, origin));
  Rigid3 pose = Rigid3::Identity();
  pose.translation() = origin;
  play_into(folder / "here", set_up_ball(folder / "here.jsonl"));
  const PlayResult there = play_into(folder / "there", set_up_ball(folder / "there.jsonl", pose));
  CHECK(there.summary["camera_from_body"][3].get<double>() == 1);
  const auto a = read_touches(folder / "here/touches.jsonl");
  const auto b = read_touches(folder / "there/touches.jsonl");
  REQUIRE(a.size() == b.size());
  REQUIRE_FALSE(a.empty());
  CHECK((*a.back().touches[0].force - *b.back().touches[0].force).norm() <
        test::tolerance(1e-4, "positions are in single precision"));
  // A finger beside the body touches nothing.
  CHECK_THAT(play_into({}, set_up_ball(folder / "there.jsonl")).text,
             Contains("never touched\nthing ") && Contains(" mm to ") && Contains("--place"));
}

TEST_CASE("a line that cannot be read ends the run in order", "[play][things][refusal]") {
  const test::ScratchFolder folder("things_play_broken");
  const fs::path file = folder / "hands.jsonl";
  test::write_bytes(file, finger_lines(5) + "{\"time\":7}\n" + finger_lines(1));
  const PlayResult result = play_into(folder / "out", set_up_ball(file));
  CHECK_THAT(result.lost, Contains("hands.jsonl: line 6: ") && Contains("\"things\""));
  CHECK(result.summary["frames"].get<int>() == 5);
  CHECK(fs::exists(folder / "out/live.json"));

  test::write_bytes(file, "\n\n");
  CHECK_THROWS_WITH(play_into({}, set_up_ball(file)), Contains("hands.jsonl: has no line"));
  test::write_bytes(file, "none\n");
  CHECK_THROWS_WITH(play_into({}, set_up_ball(file)), Contains("hands.jsonl: line 1: "));
}

TEST_CASE("a body without tables of touch is refused without a camera", "[play][things][refusal]") {
  const test::ScratchFolder folder("things_play_refused");
  test::write_bytes(folder / "hands.jsonl", finger_lines(1));
  ThingsSetUp setup = set_up_ball(folder / "hands.jsonl");
  setup.standing.clear();
  setup.standing.push_back({TouchableBody(test::DentedSphere{}.body()), Rigid3::Identity()});
  CHECK_THROWS_WITH(play_into({}, std::move(setup)),
                    Contains("sphere.palpable: has no tables of touch"));
}

}  // namespace
}  // namespace palpable
