#include "palpable/live/session/things_line.h"

#include "tests/support/test.h"

#include <fmt/format.h>

#include <array>
#include <string>
#include <vector>

namespace palpable {
namespace {

using test::tolerance;

// A line with one thing of this text.
std::string line_with(const std::string& thing) {
  return fmt::format(R"({{"time":1.5,"things":[{}]}})", thing);
}

std::string problem_of(const std::string& text, std::optional<double> after = {}) {
  const auto read = read_things_line(text, after);
  return read.ok() ? "" : read.problem().message;
}

bool says(const std::string& text, const std::string& words) {
  return problem_of(text).find(words) != std::string::npos;
}

// The joints of a straight right hand, 180 mm long, as OpenXR's list.
std::vector<Eigen::Vector3d> straight_hand() {
  std::vector<Eigen::Vector3d> joints{{0, 0.05, 0}, {0, 0, 0}};
  for (int k = 0; k < 4; ++k) joints.emplace_back(-0.03 - 0.01 * k, 0.02 + 0.025 * k, 0);
  for (int finger = 0; finger < 4; ++finger) {
    for (const double y : {0.02, 0.09, 0.13, 0.155, 0.18}) {
      joints.emplace_back(-0.03 + 0.02 * finger, y, 0);
    }
  }
  return joints;
}

std::string json_of_joints(const std::vector<Eigen::Vector3d>& joints) {
  std::string text;
  for (const Eigen::Vector3d& joint : joints) {
    text += fmt::format("{}[{},{},{}]", text.empty() ? "" : ",", joint.x(), joint.y(), joint.z());
  }
  return "[" + text + "]";
}

TEST_CASE("a line of capsules is read as it was written", "[session][things]") {
  ThingsLine line;
  line.time = 0.25;
  line.capsules = {{{0.1, 0.2, 0.3}, {0.4, 0.5, 0.6}, 0.01, 0.02},
                   {{-1, 0, 0}, {0, -1, 0}, 0.003, 0.004},
                   {{0, 0, 1}, {0, 0, 2}, 0.5, 0.25}};
  line.things = {{-7, 0, 1}, {3, 1, 2, 0.25f}, {4, 3, 0, 0.0f}, {5, 3, 0, 1.0f / 3}};
  line.wants_vertices = true;
  const std::string text = things_line(line);
  REQUIRE(text.ends_with("}\n"));
  const auto read = read_things_line(text.substr(0, text.size() - 1));
  REQUIRE(read.ok());
  CHECK(things_line(read.value()) == text);
  CHECK(read.value().capsules[2].rb == 0.25);
  CHECK(read.value().wants_vertices);

  std::vector<CapsuleThing> things(9);
  things_in(read.value(), things);
  REQUIRE(things.size() == 4);
  CHECK(things[0].id == -7);
  CHECK(things[1].capsules.size() == 2);
  CHECK(things[1].capsules.data() == &read.value().capsules[1]);
  CHECK(things[2].capsules.empty());
  CHECK(things[0].friction == kFrictionOfBody);
  CHECK(things[1].friction == 0.25f);
  CHECK(things[2].friction == 0);
  CHECK(things[3].friction == 1.0f / 3);  // to the bit, so that a recording replays
}

TEST_CASE("joints of a hand become the capsules of that hand", "[session][things]") {
  const auto joints = straight_hand();
  const std::string list = json_of_joints(joints);
  const auto hand = tracked_hand(HandLayout::kOpenXr, HandSide::kRight, joints);
  REQUIRE(hand.ok());
  const auto read = read_things_line(
      line_with(R"({"id":5,"hand":"openxr","side":"right","joints":)" + list + "}"));
  REQUIRE(read.ok());
  REQUIRE(read.value().capsules.size() == hand.value().size());
  CHECK(read.value().things.front().count == hand.value().size());
  for (std::size_t k = 0; k < hand.value().size(); ++k) {
    INFO("capsule " << k);
    CHECK((read.value().capsules[k].a - hand.value()[k].a).norm() <=
          tolerance(1e-12, "the shortest text of a number is exact"));
    CHECK((read.value().capsules[k].b - hand.value()[k].b).norm() <= 1e-12);
    CHECK(read.value().capsules[k].ra == hand.value()[k].ra);
    CHECK(read.value().capsules[k].rb == hand.value()[k].rb);
  }
  // Radii of the tracker are those of the bones.
  std::string radii = "[";
  for (int k = 0; k < 26; ++k) radii += (k == 0 ? "" : ",") + std::string("0.02");
  const auto thick =
      read_things_line(line_with(R"({"id":5,"hand":"openxr","side":"right","radii":)" + radii +
                                 R"(],"joints":)" + list + "}"));
  REQUIRE(thick.ok());
  const std::vector<double> given(26, 0.02);
  const auto with_radii = tracked_hand(HandLayout::kOpenXr, HandSide::kRight, joints, given);
  REQUIRE(with_radii.ok());
  CHECK(with_radii.value()[4].ra != hand.value()[4].ra);
  for (std::size_t k = 0; k < hand.value().size(); ++k) {
    INFO("capsule " << k);
    CHECK(thick.value().capsules[k].ra == with_radii.value()[k].ra);
    CHECK(thick.value().capsules[k].rb == with_radii.value()[k].rb);
  }
  // A left hand's palm faces the other way, so that its pads are elsewhere.
  const auto left = read_things_line(
      line_with(R"({"id":5,"hand":"openxr","side":"left","joints":)" + list + "}"));
  REQUIRE(left.ok());
  CHECK((left.value().capsules[22].a - read.value().capsules[22].a).norm() > 1e-3);

  CHECK(says(line_with(R"({"id":5,"hand":"webxr","side":"left","joints":)" + list + "}"),
             "25 joints"));
  CHECK(says(line_with(R"({"id":5,"hand":"openxr","joints":)" + list + "}"), "\"side\""));
  CHECK(says(line_with(R"({"id":5,"side":"left","joints":)" + list + "}"), "\"hand\""));
  CHECK(says(
      line_with(R"({"id":5,"hand":"openxr","side":"left","radii":[0.01],"joints":)" + list + "}"),
      "26 numbers"));
  std::vector<Eigen::Vector3d> in_mm = joints;
  for (Eigen::Vector3d& joint : in_mm) joint *= 1000;
  CHECK(says(
      line_with(R"({"id":5,"hand":"openxr","side":"left","joints":)" + json_of_joints(in_mm) + "}"),
      "in metres"));
}

TEST_CASE("what is wrong in a line is named, with what to do", "[session][things][errors]") {
  constexpr const char* kGood = R"({"id":1,"capsules":[[0,0,0,0,0,0.1,0.01,0.01]]})";
  REQUIRE(problem_of(line_with(kGood)).empty());
  REQUIRE(problem_of(R"({"time":0,"things":[],"other":3})").empty());
  for (const char* text : {"", "{", "[]", "3", "GET / HTTP/1.1", R"({"time":NaN,"things":[]})",
                           R"({"time":1e999,"things":[]})", "{\"time\":0}\n{\"time\":1}"}) {
    INFO(text);
    CHECK(says(text, "no JSON object"));
  }
  CHECK(says(R"({"things":[]})", "\"time\""));
  CHECK(says(R"({"time":"1","things":[]})", "\"time\""));
  CHECK(says(R"({"time":1.7e18,"things":[]})", "in seconds"));
  CHECK(says(R"({"time":1})", "\"things\""));
  CHECK(says(R"({"time":1,"things":{}})", "\"things\""));
  CHECK(says(R"({"time":1,"things":[],"want":"vertices"})", "\"want\""));
  CHECK(says(R"({"time":1,"things":[],"want":["skin"]})", "\"vertices\""));
  CHECK(says(line_with("3"), "thing 0: is no object"));
  CHECK(says(line_with(R"({"capsules":[]})"), "\"id\""));
  CHECK(says(line_with(R"({"id":1.5,"capsules":[]})"), "\"id\""));
  CHECK(says(line_with(R"({"id":9223372036854775808,"capsules":[]})"), "\"id\""));
  CHECK(says(line_with(R"({"id":1})"), "either"));
  CHECK(says(line_with(R"({"id":1,"capsules":[],"joints":[]})"), "either"));
  CHECK(says(line_with(std::string(kGood) + "," + kGood), "thing 1: has the id 1"));
  for (const char* capsule : {"[0,0,0,0,0,0.1,0.01]", "[0,0,0,0,0,0.1,0.01,0.01,0]", "3",
                              "[0,0,0,0,0,null,0.01,0.01]", "[0,0,0,0,0,\"1\",0.01,0.01]"}) {
    INFO(capsule);
    CHECK(says(line_with(fmt::format(R"({{"id":1,"capsules":[{}]}})", capsule)),
               "thing 0: capsule 0 is no list of eight numbers"));
  }
  CHECK(says(line_with(R"({"id":1,"capsules":[[0,0,0,0,0,2000,0.01,0.01]]})"), "1000 m"));
  CHECK(says(line_with(R"({"id":1,"capsules":[[0,0,0,0,0,0,0.01,0]]})"), "radius 0 m"));
  CHECK(says(line_with(R"({"id":1,"capsules":[[0,0,0,0,0,0,-0.01,1]]})"), "radius -0.01 m"));
}

TEST_CASE("times grow from line to line", "[session][things][errors]") {
  const std::string line = R"({"time":1.5,"things":[]})";
  CHECK(problem_of(line, 1.4).empty());
  CHECK(problem_of(line, 1.5).find("times must grow") != std::string::npos);
  CHECK(problem_of(line, 2).find("1.5 s does not come after 2 s") != std::string::npos);
}

TEST_CASE("a line has bounds", "[session][things][errors]") {
  const auto things = [](std::size_t count) {
    std::string text;
    for (std::size_t k = 0; k < count; ++k) {
      text += fmt::format(R"({}{{"id":{},"capsules":[]}})", k > 0 ? "," : "", k);
    }
    return line_with(text);
  };
  CHECK(problem_of(things(kMostThings)).empty());
  CHECK(says(things(kMostThings + 1), "257 things"));
  const auto capsules = [](std::size_t count) {
    std::string text;
    for (std::size_t k = 0; k < count; ++k) {
      text += fmt::format("{}[0,0,0,0,0,1,0.1,0.1]", k > 0 ? "," : "");
    }
    return fmt::format(R"({{"id":1,"capsules":[{}]}})", text);
  };
  CHECK(problem_of(line_with(capsules(kMostThingCapsules))).empty());
  CHECK(says(line_with(capsules(kMostThingCapsules + 1)), "4097 capsules"));
  CHECK(says(line_with(capsules(kMostThingCapsules) + R"(,{"id":2,"capsules":[[0]]})"),
             "thing 1: with it there are 4097 capsules"));
  CHECK(says(std::string(kLongestThingsLine + 1, ' '), "bytes"));
  CHECK(says(std::string(100'000, '['), "no JSON object"));
}

}  // namespace
}  // namespace palpable
