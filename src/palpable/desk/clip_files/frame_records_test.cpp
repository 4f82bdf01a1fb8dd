// For each format: the bytes of a line, reading it back, and lines that the reader refuses.
#include "palpable/desk/clip_files/frame_records.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/geometry/mesh_file.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"
#include "tests/support/text_in.h"

#include <string>
#include <vector>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
namespace fs = std::filesystem;
using test::refusal_of;
using test::says;
using test::ScratchFolder;
using test::TextIn;

/// A quarter turn about Z and a translation of (0.1, -0.2, 0.5) m.
Rigid3 some_pose() {
  Rigid3 pose = Rigid3::Identity();
  pose.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  pose.translation() = Eigen::Vector3d(0.1, -0.2, 0.5);
  return pose;
}

TEST_CASE("the touches of a frame are one line, and come back", "[clip_files]") {
  const FeltTouch finger{.site = 3,
                         .level = 0.5,
                         .press_depth = 0.00412345,
                         .force = Eigen::Vector3d(0, 0.5, -1.25),
                         .point = Eigen::Vector3d(0.01, -0.02, 0.03),
                         .time = 0.2333333333};
  const std::string line = touches_line({7, {finger, {.site = 4}}});
  CHECK(line ==
        "{\"frame\":7,\"touches\":[{\"site\":3,\"level\":0.500000,\"press_depth\":0.0041234,"
        "\"force\":[0.000000,0.500000,-1.250000],\"point\":[0.010000,-0.020000,0.030000],"
        "\"time\":0.233333},{\"site\":4}]}\n");
  CHECK(touches_line({8, {{}}}) == "{\"frame\":8,\"touches\":[{}]}\n");
  const std::string with_error = touches_line({9, {}, 0.0125, 0.25});
  CHECK(with_error ==
        "{\"frame\":9,\"touches\":[],\"displacement_error\":0.01250,\"stress_error\":0.25000}\n");
  const TextIn file(with_error + line);
  const std::vector<TouchesLine> read = read_touches(file.path);
  REQUIRE(read.size() == 2);  // sorted by frame
  CHECK(read[0].frame == 7);
  REQUIRE(read[0].touches.size() == 2);
  const FeltTouch& first = read[0].touches[0];
  CHECK(first.site == 3);
  CHECK(first.level == 0.5);
  CHECK(first.press_depth == 0.0041234);
  CHECK(first.force == Eigen::Vector3d(0, 0.5, -1.25));
  CHECK(first.point == Eigen::Vector3d(0.01, -0.02, 0.03));
  CHECK(first.time == 0.233333);
  CHECK(read[0].touches[1].site == 4);
  CHECK_FALSE(read[0].touches[1].force.has_value());
  CHECK(read[1].frame == 9);
  CHECK(read[1].touches.empty());  // an empty list: no touch
  CHECK(read[1].displacement_error == 0.0125);
  CHECK(read[1].stress_error == 0.25);
  CHECK_FALSE(read[0].displacement_error.has_value());
}

TEST_CASE("the friction of a touch comes back, and leaves no trace where there is none",
          "[clip_files][friction]") {
  const FeltTouch rubs{.friction = Eigen::Vector3d(0.25, 0, -0.5),
                       .friction_coefficient = 0.3,
                       .mean_motion = true,
                       .left_out = 12};
  const std::string line = touches_line({7, {rubs, {}}});
  CHECK(line ==
        "{\"frame\":7,\"touches\":[{\"friction\":[0.250000,0.000000,-0.500000],"
        "\"friction_coefficient\":0.300000,\"mean_motion\":true,\"left_out\":12},{}]}\n");
  const TextIn file(line);
  const std::vector<TouchesLine> read = read_touches(file.path);
  REQUIRE(read.size() == 1);
  REQUIRE(read[0].touches.size() == 2);
  CHECK(read[0].touches[0].friction == Eigen::Vector3d(0.25, 0, -0.5));
  CHECK(read[0].touches[0].friction_coefficient == 0.3);
  CHECK(read[0].touches[0].mean_motion);
  CHECK(read[0].touches[0].left_out == 12);
  CHECK_FALSE(read[0].touches[1].friction_coefficient);
  CHECK_FALSE(read[0].touches[1].mean_motion);
}

TEST_CASE("a line with one touch, the format before lists, is still read", "[clip_files]") {
  const TextIn file(
      "{\"frame\":8,\"time\":0.25,\"site\":3,\"level\":0.5,\"force\":1.25,"
      "\"press_depth\":0.004,\"point\":[0.01,-0.02,0.03]}\n"
      "{\"frame\":7}\n{\"frame\":8,\"site\":5,\"force\":\"weak\"}\n");
  const std::vector<TouchesLine> read = read_touches(file.path);
  REQUIRE(read.size() == 2);
  CHECK(read[0].frame == 7);
  REQUIRE(read[0].touches.size() == 1);
  CHECK(read[0].touches[0].site == -1);
  CHECK_FALSE(read[0].touches[0].level.has_value());
  REQUIRE(read[1].touches.size() == 2);  // two lines of one frame
  CHECK(read[1].touches[0].site == 3);
  CHECK(read[1].touches[0].level == 0.5);
  CHECK(read[1].touches[0].point == Eigen::Vector3d(0.01, -0.02, 0.03));
  CHECK_FALSE(read[1].touches[0].force.has_value());  // the magnitude alone has no direction
  CHECK(read[1].touches[1].site == 5);
}

TEST_CASE("touches that make no sense are refused with file and line", "[clip_files][errors]") {
  const auto read = [](const fs::path& path) { (void)read_touches(path); };
  CHECK(says(refusal_of("{\"frame\":0}\n{\"site\":0}\n", read),
             "file: line 2: key 'frame' not found"));
  CHECK(says(refusal_of("{\"frame\":0.5}\n", read), "line 1: 0.5 is no frame's number"));
  CHECK(says(refusal_of("{\"frame\":-4}\n", read), "line 1: frame -4 is no frame"));
  CHECK(says(refusal_of("{\"frame\":0,\"site\":-2}\n", read), "line 1: site -2 is no site"));
  CHECK(says(refusal_of("{\"frame\":0,\"site\":1.7}\n", read), "site is no whole number"));
  CHECK(says(refusal_of("{\"frame\":0,\"level\":\"x\"}\n", read), "level is no number"));
  CHECK(says(refusal_of("{\"frame\":0,\"level\":-3}\n", read), "level is negative"));
  CHECK(says(refusal_of("{\"frame\":0,\n", read), "line 1: no JSON at character"));
  const auto listed = [](const std::string& touches) {
    return "{\"frame\":0}\n{\"frame\":1,\"touches\":" + touches + "}\n";
  };
  CHECK(says(refusal_of(listed("3"), read), "line 2: touches is no list"));
  CHECK(says(refusal_of(listed("{}"), read), "line 2: touches is no list"));
  CHECK(says(refusal_of(listed("[{},3]"), read), "line 2: an entry of touches is no object"));
  CHECK(says(refusal_of(listed("[{\"site\":-2}]"), read), "line 2: site -2 is no site"));
  CHECK(
      says(refusal_of(listed("[{\"force\":2.5}]"), read), "line 2: force is no list of 3 numbers"));
}

TEST_CASE("lines that would overload a parser are refused with file and line",
          "[clip_files][errors]") {
  const auto read = [](const fs::path& path) { (void)read_touches(path); };
  const std::string deep(1'000'000, '[');
  CHECK(says(refusal_of("{\"frame\":0}\n{\"frame\":" + deep + "}\n", read),
             "file: line 2: nested more than 64 deep"));
  std::string wide;
  wide.resize(17'000'000, ' ');
  CHECK(says(refusal_of("{\"frame\":0}\n" + wide, read), "file: line 2: is longer than 16 MB"));
  const ScratchFolder folder("clip_files");
  CHECK_THROWS_WITH(read_touches(folder.path()), Catch::EndsWith("is a folder, not a file"));
}

TEST_CASE("a body's pose is the line it always was, and comes back", "[clip_files]") {
  const std::string line = pose_line({12, some_pose()});
  CHECK(line == "{\"frame\":12,\"camera_from_body\":[0,-1,0,0.1,1,0,0,-0.2,0,0,1,0.5,0,0,0,1]}\n");
  const std::vector<PoseLine> read = read_poses(TextIn(line).path);
  REQUIRE(read.size() == 1);
  CHECK(read[0].frame == 12);
  CHECK(read[0].camera_from_body.isApprox(some_pose(), 1e-14));
}

TEST_CASE("invalid poses are refused with file and line", "[clip_files][errors]") {
  const auto read = [](const fs::path& path) { (void)read_poses(path); };
  const auto with = [](const std::string& numbers) {
    return "{\"frame\":0,\"camera_from_body\":[" + numbers + "]}\n";
  };
  const std::string right = with("1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1");
  CHECK(refusal_of(right, read).empty());
  CHECK(says(refusal_of(right + right, read), "file: line 2: frame 0 comes after frame 0"));
  CHECK(says(refusal_of(with("2,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1"), read), "no rigid motion"));
  CHECK(says(refusal_of(with("1,0,0,0, 0,1,0,0, 0,0,-1,0, 0,0,0,1"), read), "no rigid motion"));
  CHECK(says(refusal_of(with("1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,1,1"), read), "no rigid motion"));
  CHECK(says(refusal_of(with("1,0,0,0"), read), "camera_from_body is no list of 16 numbers"));
}

TEST_CASE("a correction of rows is the line it always was, and comes back", "[clip_files]") {
  const std::string lines = correction_line({0, 0, {}}) + correction_line({150, 0.51204, 0.03125});
  CHECK(lines ==
        "{\"frame\":0,\"row_correction_px\":0.0000,\"row_error_px\":null}\n"
        "{\"frame\":150,\"row_correction_px\":0.5120,\"row_error_px\":0.0312}\n");
  const std::vector<CorrectionLine> read = read_corrections(TextIn(lines).path);
  REQUIRE(read.size() == 2);
  CHECK_FALSE(read[0].row_error_px.has_value());
  CHECK(read[1].frame == 150);
  CHECK(read[1].row_correction_px == 0.512);
  CHECK(read[1].row_error_px == 0.0312);
  const auto again = [](const fs::path& path) { (void)read_corrections(path); };
  CHECK(says(refusal_of("{\"frame\":0,\"row_correction_px\":null}\n", again),
             "line 1: type must be number, but is null"));
}

TEST_CASE("times of stages are the table they always were, and come back", "[clip_files]") {
  const std::vector<std::string> stages{"read", "draw", "total"};
  const std::vector<double> ms{1.25, 0.3104, 1.5604};
  const std::string text = timing_header(stages) + timing_line(4, ms);
  CHECK(text == "frame,read_ms,draw_ms,total_ms\n4,1.250,0.310,1.560\n");
  const TimingTable read = read_timing(TextIn(text).path);
  CHECK(read.stages == stages);
  CHECK(read.frames == std::vector<int>{4});
  CHECK(read.ms == std::vector<std::vector<double>>{{1.25, 0.31, 1.56}});
  const auto again = [](const fs::path& path) { (void)read_timing(path); };
  CHECK(says(refusal_of("time,read_ms\n", again), "line 1: the first column"));
  CHECK(says(refusal_of("frame,read\n", again), "line 1: column 'read' does not end in _ms"));
  CHECK(says(refusal_of("frame,read_ms\n0,1,2\n", again), "line 2: 2 numbers are wanted"));
}

TEST_CASE("true contact is the line it always was, and comes back", "[clip_files]") {
  const std::string lines =
      contact_line({.frame = 0}) +
      contact_line(
          {.frame = 1, .touching = true, .depth = 0.0041, .site = 3, .point = {{0.01, 0, -0.5}}});
  CHECK(lines ==
        "{\"frame\":0,\"touching\":false,\"depth_m\":0,\"site\":-1}\n"
        "{\"frame\":1,\"touching\":true,\"depth_m\":0.004100,\"site\":3,"
        "\"point\":[0.010000,0.000000,-0.500000]}\n");
  const std::vector<ContactLine> read = read_contacts(TextIn(lines).path);
  REQUIRE(read.size() == 2);
  CHECK_FALSE(read[0].touching);
  CHECK_FALSE(read[0].point.has_value());
  CHECK(read[1].touching);
  CHECK(read[1].depth == 0.0041);
  CHECK(read[1].site == 3);
  CHECK(read[1].point == Eigen::Vector3d(0.01, 0, -0.5));
  const auto again = [](const fs::path& path) { (void)read_contacts(path); };
  CHECK(says(refusal_of("{\"frame\":0}\n", again), "line 1: key 'touching' not found"));
  CHECK(says(refusal_of("{\"frame\":0,\"touching\":1}\n", again), "line 1: type must be boolean"));
}

TEST_CASE("a true hand is the line it always was, and comes back", "[clip_files]") {
  const Capsule finger{{0.1, 0.2, 0.3}, {0.4, 0.5, 0.6}, 0.007, 0.008};
  const std::string lines =
      hand_line({0, {}}) + hand_line({1, {finger}}) + hand_line({2, {finger, finger}});
  const std::string eight =
      "[0.100000,0.200000,0.300000,0.400000,0.500000,0.600000,0.007000,0.008000]";
  CHECK(lines == "{\"frame\":0,\"capsules\":[]}\n{\"frame\":1,\"capsules\":[" + eight +
                     "]}\n{\"frame\":2,\"capsules\":[" + eight + "," + eight + "]}\n");
  const std::vector<HandLine> read = read_hands(TextIn(lines).path);
  REQUIRE(read.size() == 3);
  CHECK(read[0].capsules.empty());
  REQUIRE(read[2].capsules.size() == 2);
  CHECK(read[2].capsules[1].a == finger.a);
  CHECK(read[2].capsules[1].b == finger.b);
  CHECK(read[2].capsules[1].ra == finger.ra);
  CHECK(read[2].capsules[1].rb == finger.rb);
  const auto again = [](const fs::path& path) { (void)read_hands(path); };
  CHECK(says(refusal_of("{\"frame\":0,\"capsules\":[[1,2,3]]}\n", again),
             "line 1: an entry of capsules is no list of 8 numbers"));
  CHECK(says(refusal_of("{\"frame\":0,\"capsules\":[[1,2,3,4,5,6,-0.1,0]]}\n", again),
             "line 1: a capsule's radius is negative"));
}

TEST_CASE("a true row offset is the line it always was, and comes back", "[clip_files]") {
  const std::string lines = rig_line({0, 0.07, false}) + rig_line({1, 0.57006, true});
  CHECK(lines ==
        "{\"frame\":0,\"row_offset_px\":0.0700}\n"
        "{\"frame\":1,\"row_offset_px\":0.5701,\"step\":true}\n");
  const std::vector<RigLine> read = read_rig(TextIn(lines).path);
  REQUIRE(read.size() == 2);
  CHECK(read[0].row_offset_px == 0.07);
  CHECK_FALSE(read[0].step);
  CHECK(read[1].frame == 1);
  CHECK(read[1].step);
  const auto again = [](const fs::path& path) { (void)read_rig(path); };
  CHECK(says(refusal_of("{\"frame\":0}\n", again), "line 1: key 'row_offset_px' not found"));
}

TEST_CASE("lines of deformed.jsonl are read as they were written, the last of a frame counts",
          "[clip_files]") {
  const test::ScratchFolder folder("deformed_lines");
  CHECK(read_deformed_lines(folder.path()).empty());
  DeformedLine touch{.frame = 7, .depth = 0.0041, .force = {0.5, -1.25, 3}, .point = {{1, 2, 3}}};
  DeformedLine doubtful{.frame = 3, .scored = false, .why = "depends on the \"way\""};
  DeformedLine earlier = touch;
  earlier.depth = 1;
  write_whole_file(folder.path() / "deformed.jsonl",
                   deformed_line(earlier) + deformed_line(touch) + deformed_line(doubtful));
  const std::vector<DeformedLine> lines = read_deformed_lines(folder.path());
  REQUIRE(lines.size() == 2);
  CHECK(lines[0].frame == 3);
  CHECK_FALSE(lines[0].scored);
  CHECK(lines[0].why == doubtful.why);
  CHECK_FALSE(lines[0].point);
  CHECK(lines[1].depth == touch.depth);
  CHECK(lines[1].force == touch.force);
  CHECK(*lines[1].point == *touch.point);

  write_whole_file(folder.path() / "deformed.jsonl", deformed_line(touch) + "{\"frame\":8}\n");
  CHECK_THROWS_WITH(read_deformed_lines(folder.path()), Contains("deformed.jsonl: line 2"));
}

TEST_CASE("a PLY with values keeps every vertex and its number", "[clip_files]") {
  const test::ScratchFolder folder("valued_ply");
  ValuedSurface written;
  // Two vertices at the same position, and one vertex that no triangle uses.
  written.surface.vertices =
      (Eigen::Matrix3Xd(3, 5) << 0, 1, 0, 0, 5, 0, 0, 1, 0, 5, 0, 0, 0, 0, 5).finished();
  written.surface.triangles = (Eigen::Matrix3Xi(3, 1) << 0, 1, 2).finished();
  written.values = Eigen::VectorXd::LinSpaced(5, 0.5, 2.5);
  const auto file = folder.path() / "skin.ply";
  write_valued_ply(file, written, kVonMisesProperty);
  const ValuedSurface read = value_or_throw(read_valued_ply(file, kVonMisesProperty));
  CHECK(read.surface.vertices == written.surface.vertices);
  CHECK(read.surface.triangles == written.surface.triangles);
  CHECK(read.values == written.values);
  CHECK(value_or_throw(read_valued_ply(file, "other")).values.size() == 0);

  write_whole_file(file,
                   "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                   "property float z\nproperty float von_mises\nelement face 1\n"
                   "property list uchar int vertex_indices\nend_header\n0 0 0 1\n1 0 0 nan\n"
                   "0 1 0 2\n3 0 1 2\n");
  CHECK_THROWS_WITH(value_or_throw(read_valued_ply(file, kVonMisesProperty)),
                    Contains("skin.ply") && Contains("von_mises is not finite"));
}

}  // namespace
}  // namespace palpable
