// For each text format: the bytes of a line, reading it back, and lines that the reader refuses.
#include "palpable/common/base/error.h"
#include "palpable/desk/clip_files/contact_file.h"
#include "palpable/desk/clip_files/frame_names.h"
#include "palpable/desk/clip_files/hand_file.h"
#include "palpable/desk/clip_files/live_file.h"
#include "palpable/desk/clip_files/pose_file.h"
#include "palpable/desk/clip_files/rectification_file.h"
#include "palpable/desk/clip_files/rig_file.h"
#include "palpable/desk/clip_files/text_file.h"
#include "palpable/desk/clip_files/timing_file.h"
#include "palpable/desk/clip_files/touches_file.h"
#include "palpable/desk/clip_files/trajectory_file.h"
#include "palpable/desk/clip_files/truth_camera_file.h"
#include "tests/support/full_disk.h"
#include "tests/support/replaced.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <functional>
#include <string>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using test::ScratchFolder;

/// A file with the given text in a folder of its own.
struct TextIn {
  explicit TextIn(const std::string& text, const char* name = "file") : path(folder / name) {
    test::write_bytes(path, text);
  }
  ScratchFolder folder{"clip_files"};
  fs::path path;
};

/// The message of the Error that `read` throws for a file with this text; empty when it throws
/// none.
std::string refusal(const std::string& text, const std::function<void(const fs::path&)>& read) {
  const TextIn file(text);
  try {
    read(file.path);
  } catch (const Error& error) { return error.what(); }
  return {};
}

bool has(const std::string& text, const std::string& part) {
  UNSCOPED_INFO("'" << part << "' is to be in: " << text);
  return text.find(part) != std::string::npos && text.find('\n') == std::string::npos;
}

/// A quarter turn about Z and a translation of (0.1, -0.2, 0.5) m.
Rigid3 some_pose() {
  Rigid3 pose = Rigid3::Identity();
  pose.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  pose.translation() = Eigen::Vector3d(0.1, -0.2, 0.5);
  return pose;
}

TEST_CASE("a pose in TUM's format is the line it always was, and comes back", "[clip_files]") {
  const std::string line = trajectory_line({1.0 / 30, some_pose()});
  CHECK(line ==
        "0.033333 0.1000000 -0.2000000 0.5000000 0.000000000 0.000000000 0.707106781 "
        "0.707106781\n");
  const TextIn file(std::string(kTrajectoryRemark) + line + "1,2, 3\t4 0 0 0 1\r\n");
  const std::vector<StampedPose> read = read_trajectory(file.path);
  REQUIRE(read.size() == 2);
  CHECK(read[0].time == 0.033333);
  CHECK(read[0].world_from_camera.isApprox(some_pose(), 1e-8));
  CHECK(read[1].world_from_camera.translation() == Eigen::Vector3d(2, 3, 4));
}

TEST_CASE("lines that are no poses are refused with file and line", "[clip_files][errors]") {
  const auto read = [](const fs::path& path) { (void)read_trajectory(path); };
  const std::string first = "0 0 0 0 0 0 0 1\n";
  CHECK(refusal("", read).empty());
  CHECK(has(refusal(first + "0.1 0 0 0 0 0 1\n", read), "file: line 2: 8 numbers are wanted"));
  CHECK(has(refusal(first + "0.1 0 0 0 0 0 0 1 5\n", read), "line 2: 8 numbers"));
  CHECK(has(refusal(first + "0.1 0 0 x 0 0 0 1\n", read), "line 2: 8 numbers"));
  CHECK(has(refusal(first + "0.1 0 0 nan 0 0 0 1\n", read), "line 2: 8 numbers"));
  CHECK(has(refusal(first + "0.1 [0 0 0] 0 0 0 1\n", read), "line 2: 8 numbers"));
  CHECK(has(refusal(first + "0.1;0;0;0;0;0;0;1\n", read), "line 2: 8 numbers"));
  CHECK(has(refusal("0 0 0 0 0 0 0 2\n", read), "line 1: the quaternion has length 2, not 1"));
  CHECK(has(refusal("# a\n" + first + first, read), "line 3: times must rise: 0 s comes after 0"));
  CHECK_THROWS_WITH(read_trajectory("nowhere.txt"), "nowhere.txt: cannot be read");
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
  CHECK(has(refusal("{\"frame\":0}\n{\"site\":0}\n", read), "file: line 2: key 'frame' not found"));
  CHECK(has(refusal("{\"frame\":0.5}\n", read), "line 1: 0.5 is no frame's number"));
  CHECK(has(refusal("{\"frame\":-4}\n", read), "line 1: frame -4 is no frame"));
  CHECK(has(refusal("{\"frame\":0,\"site\":-2}\n", read), "line 1: site -2 is no site"));
  CHECK(has(refusal("{\"frame\":0,\"site\":1.7}\n", read), "site is no whole number"));
  CHECK(has(refusal("{\"frame\":0,\"level\":\"x\"}\n", read), "level is no number"));
  CHECK(has(refusal("{\"frame\":0,\"level\":-3}\n", read), "level is negative"));
  CHECK(has(refusal("{\"frame\":0,\n", read), "line 1: no JSON at character"));
  const auto listed = [](const std::string& touches) {
    return "{\"frame\":0}\n{\"frame\":1,\"touches\":" + touches + "}\n";
  };
  CHECK(has(refusal(listed("3"), read), "line 2: touches is no list"));
  CHECK(has(refusal(listed("{}"), read), "line 2: touches is no list"));
  CHECK(has(refusal(listed("[{},3]"), read), "line 2: an entry of touches is no object"));
  CHECK(has(refusal(listed("[{\"site\":-2}]"), read), "line 2: site -2 is no site"));
  CHECK(has(refusal(listed("[{\"force\":2.5}]"), read), "line 2: force is no list of 3 numbers"));
}

TEST_CASE("lines that would overload a parser are refused with file and line",
          "[clip_files][errors]") {
  const auto read = [](const fs::path& path) { (void)read_touches(path); };
  const std::string deep(1'000'000, '[');
  CHECK(has(refusal("{\"frame\":0}\n{\"frame\":" + deep + "}\n", read),
            "file: line 2: nested more than 64 deep"));
  std::string wide;
  wide.resize(17'000'000, ' ');
  CHECK(has(refusal("{\"frame\":0}\n" + wide, read), "file: line 2: is longer than 16 MB"));
  const auto again = [](const fs::path& file) { (void)read_live_file(file); };
  CHECK(has(refusal("{\"processed\":\n" + deep, again), "file: line 2: nested more than 64 deep"));
  const auto truth = [](const fs::path& file) { (void)read_truth_camera(file); };
  CHECK(has(refusal("fps = 30\nbody" + test::repeated(".a", 60'000) + " = 1\n", truth),
            "file: line 2: nested more than 64 deep"));
  CHECK(has(refusal("fps = " + deep, truth), "file: line 1: nested more than 64 deep"));
  const ScratchFolder folder("clip_files");
  CHECK_THROWS_WITH(read_touches(folder.path()), Catch::EndsWith("cannot be read"));
}

TEST_CASE("files with names that are not UTF-8 or hold quotes can be read back",
          "[clip_files][errors]") {
  const ScratchFolder folder("clip_files");
  LiveSummary summary;
  LiveSummary::Body& body = summary.bodies.emplace_back();
  body.file = "caf\xe9.palpable";  // Latin-1
  summary.source = "a \"clip\"\n";
  summary.processed = {0, 1};
  write_live_summary(folder / "live.json", summary);
  CHECK(read_live_file(folder / "live.json").processed == std::vector<int>{0, 1});
  CHECK_THAT(test::file_bytes(folder / "live.json"),
             Catch::Contains("\"caf\xef\xbf\xbd.palpable\""));
  TruthCamera camera;
  camera.frames_per_second = 30.0;
  camera.depth_unit = 0.001;
  camera.camera = PinholeCamera{64, 36, 50, 50, 32, 18};
  camera.baseline = 0.06;
  camera.seed = 1;
  for (const std::string name : {"a'''b\"c\\d.palpable", "'", "caf\xc3\xa9", "a\nb\x01"}) {
    INFO(name);
    camera.body = name;
    camera.sequence = name;
    write_truth_camera(folder / "camera.toml", camera);
    CHECK(read_truth_camera(folder / "camera.toml").body == name);
    CHECK(read_truth_camera(folder / "camera.toml").sequence == name);
  }
  camera.body = "caf\xe9";
  write_truth_camera(folder / "camera.toml", camera);
  CHECK(read_truth_camera(folder / "camera.toml").body == "caf\xef\xbf\xbd");
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
  CHECK(refusal(right, read).empty());
  CHECK(has(refusal(right + right, read), "file: line 2: frame 0 comes after frame 0"));
  CHECK(has(refusal(with("2,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1"), read), "no rigid motion"));
  CHECK(has(refusal(with("1,0,0,0, 0,1,0,0, 0,0,-1,0, 0,0,0,1"), read), "no rigid motion"));
  CHECK(has(refusal(with("1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,1,1"), read), "no rigid motion"));
  CHECK(has(refusal(with("1,0,0,0"), read), "camera_from_body is no list of 16 numbers"));
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
  CHECK(has(refusal("{\"frame\":0,\"row_correction_px\":null}\n", again),
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
  CHECK(has(refusal("time,read_ms\n", again), "line 1: the first column"));
  CHECK(has(refusal("frame,read\n", again), "line 1: column 'read' does not end in _ms"));
  CHECK(has(refusal("frame,read_ms\n0,1,2\n", again), "line 2: 2 numbers are wanted"));
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
  CHECK(has(refusal("{\"frame\":0}\n", again), "line 1: key 'touching' not found"));
  CHECK(has(refusal("{\"frame\":0,\"touching\":1}\n", again), "line 1: type must be boolean"));
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
  CHECK(has(refusal("{\"frame\":0,\"capsules\":[[1,2,3]]}\n", again),
            "line 1: an entry of capsules is no list of 8 numbers"));
  CHECK(has(refusal("{\"frame\":0,\"capsules\":[[1,2,3,4,5,6,-0.1,0]]}\n", again),
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
  CHECK(has(refusal("{\"frame\":0}\n", again), "line 1: key 'row_offset_px' not found"));
}

TEST_CASE("a truth's camera is the file it always was, and comes back", "[clip_files]") {
  const ScratchFolder folder("clip_files");
  const fs::path path = folder / "camera.toml";
  TruthCamera camera;
  camera.frames_per_second = 30.0;
  camera.depth_unit = 0.00025;
  camera.camera = PinholeCamera{640, 360, 350.123456789012, 350.5, 319.25, 179.75};
  camera.baseline = 0.0630187;
  camera.sequence = "press";
  camera.seed = 5;
  camera.body = "bunny.palpable";
  write_truth_camera(path, camera);
  CHECK(test::file_bytes(path) ==
        "# The rectified left camera at half size: px; baseline in m.\n"
        "width = 640\nheight = 360\nfx = 350.123456789\nfy = 350.5\ncx = 319.25\ncy = 179.75\n"
        "baseline_m = 0.0630187\nfps = 30\ndepth_unit_m = 0.00025\nsequence = \"press\"\n"
        "seed = 5\nbody = '''bunny.palpable'''\n");
  const TruthCamera read = read_truth_camera(path);
  CHECK(read.frames_per_second == 30);
  CHECK(read.depth_unit == 0.00025);
  REQUIRE(read.camera.has_value());
  CHECK(read.camera->width == 640);
  CHECK(read.camera->height == 360);
  CHECK(read.camera->fx_px == 350.123456789);
  CHECK(read.camera->fy_px == 350.5);
  CHECK(read.camera->cx_px == 319.25);
  CHECK(read.camera->cy_px == 179.75);
  CHECK(read.baseline == 0.0630187);
  CHECK(read.sequence == "press");
  CHECK(read.seed == 5U);
  CHECK(read.body == "bunny.palpable");
  const auto again = [](const fs::path& file) { (void)read_truth_camera(file); };
  CHECK(refusal("fps = 30\ndepth_unit_m = 0.001\n", again).empty());
  CHECK(has(refusal("fps = 30\n", again), "file: has no depth_unit_m"));
  CHECK(has(refusal("fps = 30\ndepth_unit_m = -1\n", again),
            "file: line 2: depth_unit_m must be a number above 0"));
  CHECK(has(refusal("fps = = 3\n", again), "file: line 1: "));
}

TEST_CASE("what a run says about itself is the file it always was", "[clip_files]") {
  const ScratchFolder folder("clip_files");
  const fs::path path = folder / "live.json";
  LiveSummary summary;
  LiveSummary::Body& body = summary.bodies.emplace_back();
  body.file = "bunny.palpable";
  summary.source = "clip";
  body.contact = "press";
  summary.view = "camera";
  summary.press_static = true;
  body.camera_from_body = some_pose();
  summary.tracking = {3, {1}, 1, 0, 7, 500, {2}};
  summary.map = {12, 0, 2};
  summary.depth = {0.5, {}, {2}, 0.75};
  summary.unreadable = 1;
  summary.source_troubles = {0, 1, 2, 3, {"a camera"}};
  summary.frames_touching = 1;
  summary.first_touch_frame = 2;
  summary.deepest_press = 0.004;
  summary.video_codec = "avc1";
  summary.left_out = 3;
  summary.lines_left_out = 1;
  summary.color_scale = 1.5e5;
  summary.wall = 2.5;
  summary.states = {"0123456789abcdef", 3};
  summary.stats = {31.5, 40, 61, 44.5, {{"draw", 8}}, {{"draw", 12}}};
  summary.median_ms = {{"read", 1.25}, {"total", 14.0}};
  summary.processed = {0, 2};
  write_live_summary(path, summary);
  CHECK(test::file_bytes(path) == R"({
  "body": "bunny.palpable",
  "source": "clip",
  "contact": "press",
  "view": "camera",
  "press_static": true,
  "scale": 1.0,
  "camera_from_body": [
    0.0,
    -1.0,
    0.0,
    0.1,
    1.0,
    0.0,
    0.0,
    -0.2,
    0.0,
    0.0,
    1.0,
    0.5,
    0.0,
    0.0,
    0.0,
    1.0
  ],
  "color_from_depth": null,
  "tracking": {
    "frames_moving": 3,
    "frames_lost": [
      1
    ],
    "times_found_again": 1,
    "loops_closed": 0,
    "keyframes": 7,
    "landmarks": 500,
    "new_worlds": [
      2
    ]
  },
  "map": {
    "blocks": 12,
    "refused": 0,
    "free_space_refused": 2
  },
  "depth": {
    "median_density": 0.5,
    "frames_few_depths": [],
    "frames_rows_off": [
      2
    ],
    "rows_off_px": 0.75
  },
  "frames": 2,
  "unreadable": 1,
  "source_troubles": {
    "back_in_time": 0,
    "dropped": 1,
    "stalls": 2,
    "losses": 3,
    "reports": [
      "a camera"
    ]
  },
  "frames_touching": 1,
  "first_touch_frame": 2,
  "deepest_press_m": 0.004,
  "frames_step_limited": 0,
  "frames_contacts_dropped": 0,
  "site_changes": 0,
  "video_codec": "avc1",
  "pictures": [],
  "frames_left_out": 3,
  "lines_left_out": 1,
  "color_scale_pa": 150000.0,
  "wall_s": 2.5,
  "states": {
    "hash": "0123456789abcdef",
    "frames": 3
  },
  "stats": {
    "frames_per_s": 31.5,
    "age_p50_ms": 40.0,
    "age_p99_ms": 61.0,
    "cpu_ms_per_frame": 44.5,
    "stage_p50_ms": {
      "draw": 8.0
    },
    "stage_p99_ms": {
      "draw": 12.0
    }
  },
  "median_ms": {
    "read": 1.25,
    "total": 14.0
  },
  "processed": [
    0,
    2
  ]
}
)");
  const LiveFile read = read_live_file(path);
  CHECK(read.processed == std::vector<int>{0, 2});
  CHECK(read.camera_from_body->isApprox(some_pose(), 1e-14));
  CHECK_FALSE(read_live_file(TextIn("{}").path).processed.has_value());
  const auto again = [](const fs::path& file) { (void)read_live_file(file); };
  CHECK(has(refusal("{\"processed\":[0,\n\n", again), "file: no JSON at character"));
  CHECK(has(refusal("{\"processed\":[0,1.5]}", again), "file: 1.5 is no frame's number"));
  CHECK(has(refusal("{\"processed\":2}", again), "file: processed is no list of frames"));
  CHECK(has(refusal("[1]", again), "file: is no JSON object"));
  CHECK(has(refusal("{\"camera_from_body\":[1]}", again), "no list of 16 numbers"));
}

TEST_CASE("frames are counted by their names, and other names are refused", "[clip_files]") {
  const ScratchFolder folder("clip_files");
  CHECK(frame_name(7, ".png") == "000007.png");
  CHECK(frames_in(folder / "nowhere") == 0);
  CHECK(frames_in(folder.path()) == 0);
  CHECK_NOTHROW(expect_frames_in(folder.path(), ".png"));
  test::write_bytes(folder / "frame_3.png", "");
  CHECK(frames_in(folder.path()) == 0);
  CHECK_THROWS_WITH(expect_frames_in(folder.path(), ".png"),
                    Catch::Contains("frame_3.png is no frame's name: they are 000000.png"));
  test::write_bytes(folder / "000041.png", "");
  CHECK(frames_in(folder.path()) == 42);
  CHECK_NOTHROW(expect_frames_in(folder.path(), ".png"));
  CHECK_THROWS_WITH(expect_frames_in(folder.path(), ".ply"), Catch::Contains("000000.ply"));
  CHECK_THROWS_WITH(expect_frames_in(folder / "frame_3.png", ".png"),
                    Catch::Contains("is no folder"));
}

TEST_CASE("a text that cannot be written is an error", "[clip_files][errors]") {
  const ScratchFolder folder("clip_files");
  CHECK_THROWS_WITH(TextFile(folder / "nowhere/a.txt"),
                    Catch::Contains("a.txt: cannot be written"));
  TextFile full("/dev/full");
  full.write("text\n");
  CHECK_THROWS_WITH(full.close(), "/dev/full: cannot be written: No space left on device");
}

TEST_CASE("lines of a text file are on the disk after flush() or close()", "[clip_files]") {
  const ScratchFolder folder("clip_files");
  const fs::path path = folder / "a.csv";
  TextFile text(path);
  text.write("1,2\n");
  CHECK(test::file_bytes(path).empty());  // a single line stays in memory
  text.flush();
  CHECK(test::file_bytes(path) == "1,2\n");
  text.write("3,4\n");
  text.close();
  CHECK(test::file_bytes(path) == "1,2\n3,4\n");
  {
    TextFile given_up(path);
    given_up.write("5,6\n");
  }
  CHECK(test::file_bytes(path) == "5,6\n");
}

TEST_CASE("a text on a full disk ends with a whole line", "[clip_files][errors]") {
  const ScratchFolder folder("clip_files");
  const fs::path path = folder / "a.csv";
  const test::FileSizeLimit limit(10);
  TextFile text(path);
  text.write("1,2\n");
  text.flush();
  text.write("3,4\n5,6\n");
  CHECK_THROWS_WITH(text.flush(), Catch::EndsWith("a.csv: cannot be written: File too large"));
  CHECK(test::file_bytes(path) == "1,2\n");
}

}  // namespace
}  // namespace palpable
