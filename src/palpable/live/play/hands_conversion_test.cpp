#include "palpable/live/play/hands_conversion.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/desk/clip_files/camera_paths.h"
#include "palpable/desk/clip_files/frame_records.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <fmt/core.h>

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Eigen::Vector3d;
using test::tolerance;

// A flat right hand of MediaPipe's 21 joints, m: the wrist at `wrist`, the fingers along X.
std::vector<Vector3d> flat_hand(const Vector3d& wrist) {
  std::vector<Vector3d> joints{wrist};
  for (int k = 0; k < 4; ++k) joints.push_back(wrist + Vector3d(0.02 + 0.03 * k, 0.05, 0));
  for (int finger = 0; finger < 4; ++finger) {
    const double y = 0.03 - 0.02 * finger;
    for (const double x : {0.09, 0.13, 0.155, 0.175}) joints.push_back(wrist + Vector3d(x, y, 0));
  }
  return joints;
}

std::string cells(const std::vector<Vector3d>& joints, double scale, const char* separator = ",") {
  std::string text;
  for (const Vector3d& joint : joints) {
    for (const double value : joint) text += fmt::format("{}{:.6f}", separator, scale * value);
  }
  return text;
}

std::vector<ThingsLine> lines_of(const std::string& text, const JointsTable& table = {}) {
  const test::ScratchFolder folder("joints_table");
  write_whole_file(folder / "joints.csv", text);
  return read_joints_table(folder / "joints.csv", table).lines;
}

// What is said of a table.
std::vector<std::string> warnings_of(const std::string& text, const JointsTable& table = {}) {
  const test::ScratchFolder folder("joints_warnings");
  write_whole_file(folder / "joints.csv", text);
  const JointsRead read = read_joints_table(folder / "joints.csv", table);
  return joints_warnings(hands_text(read.lines), table, read.found);
}

void check_capsules(const ThingsLine& line, const ThingsLine::Thing& thing, HandSide side,
                    const std::vector<Vector3d>& joints) {
  const TrackedHand hand = tracked_hand(HandLayout::kMediaPipe, side, joints).value();
  REQUIRE(thing.count == hand.size());
  for (std::size_t k = 0; k < hand.size(); ++k) {
    const Capsule& found = line.capsules[thing.first + k];
    CHECK((found.a - hand[k].a).norm() <= tolerance(3e-6, "six decimals of every joint"));
    CHECK((found.b - hand[k].b).norm() <= tolerance(3e-6, "six decimals of every joint"));
    CHECK(std::abs(found.ra - hand[k].ra) <= tolerance(3e-6, "six decimals of every joint"));
  }
}

TEST_CASE("a table of joints becomes hands in metres, with Z up, from time 0 on", "[play]") {
  const std::vector<Vector3d> joints = flat_hand({0.1, 0.2, 0.3});
  SECTION("metres and seconds") {
    const auto lines = lines_of("7.5" + cells(joints, 1) + "\n7.6" + cells(joints, 1) + "\n");
    REQUIRE(lines.size() == 2);
    CHECK(lines[0].time == 0);
    CHECK(lines[1].time == Approx(0.1));
    REQUIRE(lines[1].things.size() == 1);
    CHECK(lines[1].things[0].id == 1);
    check_capsules(lines[1], lines[1].things[0], HandSide::kRight, joints);
  }
  SECTION("millimetres, milliseconds, Y up, names in the first row, tabs") {
    std::vector<Vector3d> turned;
    for (const Vector3d& p : joints) turned.emplace_back(p.x(), p.z(), -p.y());
    const auto lines =
        lines_of("\xef\xbb\xbftime\tx0\ty0\n# made by hand\n1000" + cells(turned, 1e3, "\t") +
                     "\r\n1500" + cells(turned, 1e3, "\t") + "\r\n",
                 {.metres = 1e-3, .seconds = 1e-3, .has_y_up = true});
    REQUIRE(lines.size() == 2);
    CHECK(lines[1].time == Approx(0.5));
    check_capsules(lines[1], lines[1].things[0], HandSide::kRight, joints);
  }
  SECTION("two hands in two rows of one time, and one that is lost") {
    const std::vector<Vector3d> other = flat_hand({0.1, -0.2, 0.3});
    std::string lost = cells(joints, 1);
    lost.replace(lost.size() - 8, 8, "nan");
    const auto lines =
        lines_of("time,side\n1,right" + cells(joints, 1) + "\n1,Left" + cells(other, 1) +
                 "\n2,right" + lost + "\n3,left\n4,right" + std::string(63, ',') + "\n");
    REQUIRE(lines.size() == 4);
    REQUIRE(lines[0].things.size() == 2);
    CHECK(lines[0].things[1].id == 2);
    check_capsules(lines[0], lines[0].things[0], HandSide::kRight, joints);
    check_capsules(lines[0], lines[0].things[1], HandSide::kLeft, other);
    for (std::size_t k = 1; k < 4; ++k) CHECK(lines[k].things.empty());
  }
  SECTION("a radius with each joint") {
    std::string row = "0";
    for (const Vector3d& p : joints) {
      row += fmt::format(" {} {} {} 0.0123", p.x(), p.y(), p.z());
    }
    const auto lines = lines_of(row + "\n");
    REQUIRE(lines.size() == 1);
    CHECK(lines[0].capsules[0].ra == Approx(0.0123));
  }
}

TEST_CASE("what is no table of joints is refused with its row and the reason", "[play]") {
  const std::string row = "1" + cells(flat_hand({0, 0, 0}), 1) + "\n";
  const auto refuses = [](const std::string& text, const std::string& says,
                          const JointsTable& table = {}) {
    INFO(text.substr(0, 40));
    CHECK_THROWS_WITH(lines_of(text, table), Contains(says));
  };
  refuses("", "joints.csv: has no row of joints");
  refuses("time,x\n", "has no row of joints");
  refuses(row + "2,1,2,3\n",
          "joints.csv: line 2: has 3 numbers of joints instead of 78 or 104 (openxr");
  refuses(row, "line 1: has 63 numbers of joints instead of 78 or 104",
          {.layout = HandLayout::kOpenXr});
  refuses(row + "0.5,right\n", "line 2: the time 0.5 follows 1; times must not go back");
  refuses(row + row, "line 2: is a second right hand at the same time");
  refuses("1,middle" + cells(flat_hand({0, 0, 0}), 1) + "\n", "'middle' is neither a number nor");
  refuses(row + "two,3\n", "line 2: 'two' is no time");
  refuses(row + "2,3,x\n", "line 2: column 3: 'x' is no number");
  refuses("1" + cells(flat_hand({0, 0, 0}), 1e3) + "\n", "(--unit says in what they are)");
  refuses("1;0,5;1,25\n2;0,5;1,25\n", "has decimal commas");
}

TEST_CASE("what was found in a table is told", "[play]") {
  const test::ScratchFolder folder("joints_found");
  const auto read = [&](const std::string& text, const JointsTable& table = {}) {
    write_whole_file(folder / "joints.csv", text);
    return read_joints_table(folder / "joints.csv", table);
  };
  const std::vector<Vector3d> joints = flat_hand({0.1, 0.2, 0.3});
  const JointsRead one = read("time,side,x0\n1,Left" + cells(joints, 1) + "\n");
  CHECK(one.found.layout == HandLayout::kMediaPipe);
  CHECK(one.found.is_counted);
  CHECK_FALSE(one.found.has_radii);
  CHECK((one.found.has_left && !one.found.has_right));
  CHECK(one.found.first_name == "x0");
  const HandsText made =
      hands_text(read("0" + cells(joints, 1) + "\n0.02" + cells(joints, 1) + "\n").lines);
  CHECK(made.step == Approx(0.02));
  CHECK(made.box.contains(Vector3d(0.1, 0.2, 0.3)));
  CHECK(made.box.sizes().maxCoeff() < 0.25);
  CHECK(hands_text({}).box.isEmpty());
}

TEST_CASE("a table that is probably something else than what it was taken for is warned of",
          "[play]") {
  const auto rows = [](const std::vector<Vector3d>& joints, double step) {
    return fmt::format("0{0}\n{1}{0}\n", cells(joints, 1), step);
  };
  const std::vector<Vector3d> hand = flat_hand({0.1, 0.2, 0.3});
  CHECK(warnings_of(rows(hand, 0.02)).empty());
  const auto has = [](const std::vector<std::string>& warnings, const std::string& says) {
    INFO(says);
    REQUIRE(warnings.size() == 1);
    CHECK_THAT(warnings.front(), Contains(says));
  };
  has(warnings_of(rows(hand, 20)), "--time-unit");
  has(warnings_of(rows(hand, 2e-5)), "--time-unit");
  std::vector<Vector3d> headset;  // 1 m above the floor along Y, before the user along -Z
  for (const Vector3d& x : flat_hand({0, 0, 0}))
    headset.emplace_back(x.x(), 1 + x.z(), -0.5 - x.y());
  has(warnings_of(rows(headset, 0.02)), "--up y says so");
  CHECK(warnings_of(rows(headset, 0.02), {.has_y_up = true}).empty());
  const std::vector<Vector3d> behind = flat_hand({0, -0.5, 0.3});  // Z up
  CHECK(warnings_of(rows(behind, 0.02)).empty());
  has(warnings_of(rows(behind, 0.02), {.has_y_up = true}), "leave out --up y");
  // 25 joints: WebXR's order is assumed.
  std::vector<Vector3d> webxr = hand;
  for (const std::size_t metacarpal : {5, 10, 15, 20}) {
    webxr.insert(webxr.begin() + static_cast<std::ptrdiff_t>(metacarpal),
                 hand[0] + Vector3d(0.03, 0, 0));
  }
  REQUIRE(webxr.size() == 25);
  CHECK(warnings_of(rows(webxr, 0.02)).empty());
  CHECK(warnings_of("time,Wrist_x\n" + rows(webxr, 0.02)).empty());
  has(warnings_of("time,palm.x\n" + rows(webxr, 0.02)), "palm.x");
  CHECK(warnings_of("time,palm.x\n" + rows(webxr, 0.02), {.layout = HandLayout::kWebXr}).empty());
}

TEST_CASE("the hand of a clip stands in the frame of its body", "[play]") {
  const test::ScratchFolder folder("clip_things");
  make_folder(folder / "frames");
  make_folder(folder / "truth");
  // The body stands upright, 0.4 m in front of a camera that does not move.
  write_whole_file(folder / "frames" / "scene.toml",
                   "camera_from_body = [1,0,0,0, 0,0,-1,0, 0,1,0,0.4, 0,0,0,1]\n");
  std::string poses;
  for (int n = 0; n < 2; ++n) poses += trajectory_line({.time = n / 30.0});
  write_whole_file(folder / "truth" / "trajectory.txt", poses);
  write_whole_file(folder / "truth" / "contact.jsonl",
                   contact_line({.frame = 0}) + contact_line({.frame = 1}));
  write_whole_file(
      folder / "truth" / "hand.jsonl",
      hand_line({0, {}}) + hand_line({1, {{{0, -0.05, 0.4}, {0, -0.15, 0.4}, 0.01, 0.02}}}));
  const std::vector<ThingsLine> lines = read_clip_things(folder.path());
  REQUIRE(lines.size() == 2);
  CHECK(lines[0].things.empty());
  CHECK(lines[1].time == Approx(1 / 30.0).margin(1e-6));
  REQUIRE(lines[1].things.size() == 1);
  CHECK(lines[1].things[0].count == 1);
  CHECK((lines[1].capsules[0].b - Vector3d(0, 0, 0.15)).norm() <= tolerance(1e-6, "six decimals"));
}

}  // namespace
}  // namespace palpable
