#include "palpable/desk/clip_files/live_file.h"

#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"
#include "tests/support/text_in.h"

#include <string>
#include <vector>

namespace palpable {
namespace {

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
  summary.depth = {0.5, {}, {2}, 0.75, 0.75, 0.25, 0.5, 0.25, 1.5, 0.001, true};
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
    "relocalizations": 1,
    "loops_closed": 0,
    "keyframes": 7,
    "landmarks": 500,
    "new_worlds": [
      2
    ]
  },
  "map": {
    "blocks": 12,
    "blocks_refused": 0,
    "free_space_blocks_refused": 2
  },
  "depth": {
    "median_density": 0.5,
    "median_measured": 0.75,
    "median_kept": 0.25,
    "median_written": null,
    "median_m": 0.5,
    "range_m": [
      0.25,
      1.5
    ],
    "unit_m": 0.001,
    "unit_assumed": true,
    "frames_sparse_depth": [],
    "frames_rows_misaligned": [
      2
    ],
    "row_misalignment_px": 0.75
  },
  "frames": 2,
  "frames_unreadable": 1,
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
  CHECK(read.speed.frames_per_second == 31.5);
  CHECK(read.speed.cpu_ms_per_frame == 44.5);
  CHECK(read.speed.age_p99_ms == 61);
  CHECK(read.speed.dropped.has_value());
  CHECK_FALSE(read_live_file(TextIn("{}").path).processed.has_value());
  CHECK_FALSE(read_live_file(TextIn("{}").path).speed.frames_per_second.has_value());
  // Files of older versions have no "stats"; what others write there is no error.
  CHECK(read_live_file(TextIn("{\"frames\":50,\"wall_s\":2.5}").path).speed.frames_per_second ==
        20);
  CHECK_FALSE(read_live_file(TextIn("{\"stats\":7,\"source_troubles\":[],\"wall_s\":0}").path)
                  .speed.frames_per_second.has_value());
  const auto again = [](const fs::path& file) { (void)read_live_file(file); };
  CHECK(says(refusal_of("{\"processed\":[0,\n\n", again), "file: no JSON at character"));
  CHECK(says(refusal_of("{\"processed\":[0,1.5]}", again), "file: 1.5 is no frame's number"));
  CHECK(says(refusal_of("{\"processed\":2}", again), "file: processed is no list of frames"));
  CHECK(says(refusal_of("[1]", again), "file: is no JSON object"));
  CHECK(says(refusal_of("{\"camera_from_body\":[1]}", again), "no list of 16 numbers"));
}

TEST_CASE("a run with friction states its coefficients, and what is left of the conditions",
          "[clip_files][friction]") {
  LiveSummary summary;
  summary.bodies.resize(2);
  CHECK_FALSE(json_of(summary).contains("friction"));
  CHECK_FALSE(json_of(summary).contains("friction_residual_m"));
  summary.bodies[0].friction = 0.3;
  summary.friction_residual = 2e-6;
  const Json one = json_of(summary);
  CHECK(one["friction"].get<double>() == 0.3);
  CHECK(one["friction_residual_m"].get<double>() == 2e-6);
  summary.scene = "two.toml";
  const Json two = json_of(summary);
  const Json& bodies = two["bodies"];
  CHECK(bodies[0]["friction"].get<double>() == 0.3);
  CHECK_FALSE(bodies[1].contains("friction"));
}

TEST_CASE("a summary that would overload a parser is refused with file and line",
          "[clip_files][errors]") {
  const std::string deep(1'000'000, '[');
  const auto again = [](const fs::path& file) { (void)read_live_file(file); };
  CHECK(says(refusal_of("{\"processed\":\n" + deep, again),
             "file: line 2: nested more than 64 deep"));
}

TEST_CASE("a summary with names that are not UTF-8 or hold quotes can be read back",
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
}

}  // namespace
}  // namespace palpable
