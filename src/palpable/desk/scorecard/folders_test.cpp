#include "palpable/desk/scorecard/folders.h"

#include "palpable/common/base/error.h"
#include "palpable/desk/scorecard/figures.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <fstream>
#include <string>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using test::ScratchFolder;

const char* const kCamera = "fps = 30\ndepth_unit_m = 0.00025\n";
const char* const kIdentity = "[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]";

void write(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream(path) << text;
}

// The message of the Error that `read` throws; empty when it throws none.
template <class Read>
std::string refusal(Read read) {
  try {
    read();
  } catch (const Error& error) { return error.what(); }
  return {};
}

std::string truth_refusal(const char* file, const std::string& text) {
  const ScratchFolder folder("scorecard");
  write(folder / "camera.toml", kCamera);
  write(folder / "contact.jsonl",
        "{\"frame\":0,\"touching\":false}\n{\"frame\":1,\"touching\":true}\n");
  write(folder / file, text);
  return refusal([&] { (void)read_truth_folder(folder.path()); });
}

std::string result_refusal(const char* file, const std::string& text) {
  const ScratchFolder folder("scorecard");
  write(folder / "touches.jsonl", "");
  write(folder / file, text);
  return refusal([&] { (void)read_result_folder(folder.path(), 2); });
}

bool says(const std::string& text, std::initializer_list<const char*> parts) {
  INFO(text);
  for (const char* part : parts) {
    if (text.find(part) == std::string::npos) {
      UNSCOPED_INFO("'" << part << "' is not in: " << text);
      return false;
    }
  }
  return text.find('\n') == std::string::npos;
}

TEST_CASE("a truth is read from its files", "[scorecard]") {
  const ScratchFolder folder("scorecard");
  const fs::path truth = folder / "truth";
  write(truth / "camera.toml", kCamera);
  write(truth / "contact.jsonl",
        "{\"frame\":0,\"touching\":false,\"depth_m\":0,\"site\":-1}\n"
        "{\"frame\":1,\"touching\":true,\"depth_m\":0.004,\"site\":3}\n");
  write(truth / "hand.jsonl",
        "{\"frame\":0,\"capsules\":[]}\n{\"frame\":1,\"capsules\":[[1,2,3,4,5,6,0.1,0.2]]}\n");
  write(truth / "trajectory.txt", "# a comment\n0 0 0 0 0 0 0 1\n0.033333 1 2 3 0 0 1 0\n");
  write(truth / "rig.jsonl",
        "{\"frame\":0,\"row_offset_px\":0.1}\n{\"frame\":1,\"row_offset_px\":0.6,\"step\":true}\n");
  for (const fs::path& given : {truth, folder.path()}) {
    const TruthFolder read = read_truth_folder(given);
    CHECK(read.frames == 2);
    CHECK(read.depth_unit == 0.00025);
    CHECK(read.frames_per_second == 30);
    CHECK_FALSE(read.contacts[0].touching);
    CHECK(read.contacts[1].touching);
    CHECK(read.contacts[1].site == 3);
    REQUIRE(read.hands.size() == 1);
    CHECK(read.hands.at(1)[0].b == Eigen::Vector3d(4, 5, 6));
    CHECK(read.hands.at(1)[0].rb == 0.2);
    CHECK(read.trajectory[1].world_from_camera * Eigen::Vector3d(1, 0, 0) ==
          Eigen::Vector3d(0, 2, 3));
    CHECK(read.rows[1].offset_px == 0.6);
    CHECK(read.rows[1].step);
    CHECK_FALSE(read.rows[0].step);
  }
}

TEST_CASE("a result may lack files", "[scorecard]") {
  const ScratchFolder folder("scorecard");
  write(folder / "touches.jsonl", "{\"frame\":1}\n{\"frame\":2,\"site\":4,\"level\":0.5}\n");
  ResultFolder result = read_result_folder(folder.path(), 3);
  CHECK(result.processed == std::vector<std::uint8_t>{1, 1, 1});
  CHECK(result.touches->at(1).front().site == -1);
  CHECK_FALSE(result.touches->at(1).front().level.has_value());
  CHECK(result.touches->at(2).front().site == 4);
  CHECK_FALSE(result.poses.has_value());
  CHECK_FALSE(result.trajectory.has_value());
  CHECK_FALSE(result.corrections.has_value());
  CHECK_FALSE(result.pose_at(0).has_value());

  write(folder / "live.json", std::string("{\"processed\":[0,2,7],\"camera_from_body\":") +
                                  "[1,0,0,5, 0,1,0,0, 0,0,1,0, 0,0,0,1]}");
  result = read_result_folder(folder.path(), 3);
  CHECK(result.processed == std::vector<std::uint8_t>{1, 0, 1});
  CHECK(result.pose_at(2)->translation().x() == 5);

  write(folder / "pose.jsonl",
        std::string("{\"frame\":1,\"camera_from_body\":") + kIdentity + "}\n");
  result = read_result_folder(folder.path(), 3);
  CHECK(result.pose_at(1)->translation().x() == 0);
  CHECK_FALSE(result.pose_at(2).has_value());
}

TEST_CASE("each of several bodies is read and scored by itself", "[scorecard][scene]") {
  const ScratchFolder folder("scorecard_scene");
  const fs::path truth = folder / "truth", result = folder / "result";
  write(truth / "camera.toml", kCamera);
  write(truth / "trajectory.txt", "0 0 0 0 0 0 0 1\n0.033333 0 0 0 0 0 0 1\n");
  const auto contact = [](bool touching) {
    return std::string("{\"frame\":0,\"touching\":false}\n{\"frame\":1,\"touching\":") +
           (touching ? "true,\"depth_m\":0.005}\n" : "false}\n");
  };
  write(truth / "bodies/lower/contact.jsonl", contact(false));
  write(truth / "bodies/upper/contact.jsonl", contact(true));
  write(result / "touches.jsonl",
        "{\"frame\":1,\"body\":\"lower\",\"touches\":[{\"by\":\"upper\",\"force\":[0,0,-1]}]}\n"
        "{\"frame\":1,\"body\":\"upper\",\"touches\":[{\"force\":[0,0,-2]}]}\n");
  CHECK(bodies_of_truth(folder.path()) == std::vector<std::string>{"lower", "upper"});
  CHECK(read_truth_folder(truth, "upper").contacts[1].touching);
  CHECK(read_result_folder(result, 2, "upper").touches->at(1).front().force->z() == -2);
  CHECK(read_result_folder(result, 2, "lower").touches->at(1).front().by_body);
  const Scorecard scores = score_folders(truth, result, nullptr, {});
  REQUIRE(scores.bodies.size() == 2);
  CHECK(scores.bodies[0].name == "lower");
  // The contact of the two bodies does not count as a falsely felt touch of the lower one.
  CHECK(scores.bodies[0].touch_recall == std::nullopt);
  CHECK(scores.bodies[0].frames_touching == 0);
  CHECK(scores.bodies[1].touch_recall == 1.0);
  CHECK_FALSE(scores.body.frames_touching.has_value());
  CHECK(json_of(scores).find("\"upper\"") != std::string::npos);
  CHECK(text_of(scores).find("upper\n") != std::string::npos);
}

TEST_CASE("a truth that makes no sense is refused with file and line", "[scorecard][errors]") {
  CHECK(truth_refusal("script.toml", "anything").empty());
  CHECK(says(truth_refusal("camera.toml", "fps = 30\n"), {"camera.toml", "depth_unit_m"}));
  CHECK(says(truth_refusal("camera.toml", "fps = 30\ndepth_unit_m = -1\n"),
             {"camera.toml: line 2", "depth_unit_m", "above 0"}));
  CHECK(says(truth_refusal("camera.toml", "fps = 30\nfps = = 3\n"), {"camera.toml: line 2"}));
  CHECK(says(truth_refusal("contact.jsonl", "{\"frame\":0,\"touching\":false}\n{\"frame\":1}\n"),
             {"contact.jsonl: line 2", "touching"}));
  CHECK(says(truth_refusal("contact.jsonl", "{\"frame\":0,\"touching\":false}\n{oops\n"),
             {"contact.jsonl: line 2"}));
  CHECK(says(truth_refusal("contact.jsonl",
                           "{\"frame\":1,\"touching\":true}\n{\"frame\":1,\"touching\":true}\n"),
             {"contact.jsonl: line 2", "frame 1 comes after frame 1"}));
  CHECK(says(truth_refusal("contact.jsonl", "{\"frame\":-4,\"touching\":true}\n"),
             {"contact.jsonl: line 1", "-4"}));
  CHECK(says(truth_refusal("hand.jsonl", "{\"frame\":0,\"capsules\":[[1,2,3]]}\n"),
             {"hand.jsonl: line 1"}));
  CHECK(says(truth_refusal("hand.jsonl", "{\"frame\":0,\"capsules\":[[1,2,3,4,5,6,-0.1,0]]}\n"),
             {"hand.jsonl: line 1", "negative"}));
  CHECK(says(truth_refusal("trajectory.txt", "0 0 0 0 0 0 0 1\n0.1 0 0 0 0 0 1\n"),
             {"trajectory.txt: line 2", "8 numbers"}));
  CHECK(says(truth_refusal("trajectory.txt", "0 0 0 0 0 0 0 1\n0 0 0 0 0 0 0 1\n"),
             {"trajectory.txt: line 2", "comes after"}));
  CHECK(says(truth_refusal("trajectory.txt", "0 0 0 0 0 0 0 2\n"),
             {"trajectory.txt: line 1", "length 2"}));
  CHECK(says(truth_refusal("trajectory.txt", "0 0 0 0 0 0 0 1\n"),
             {"trajectory.txt", "1 frames", "has 2"}));
  CHECK(
      says(truth_refusal("rig.jsonl", "{\"frame\":0}\n"), {"rig.jsonl: line 1", "row_offset_px"}));
}

TEST_CASE("a result that makes no sense is refused with file and line", "[scorecard][errors]") {
  CHECK(result_refusal("notes.txt", "anything").empty());
  CHECK(says(result_refusal("touches.jsonl", "{\"frame\":0}\n{\"site\":0}\n"),
             {"touches.jsonl: line 2", "frame"}));
  CHECK(says(result_refusal("touches.jsonl", "{\"frame\":0,\"site\":-2}\n"),
             {"touches.jsonl: line 1", "-2"}));
  CHECK(says(result_refusal("touches.jsonl", "{\"frame\":0,\"site\":1.7}\n"),
             {"touches.jsonl: line 1", "site is no whole number"}));
  CHECK(says(result_refusal("touches.jsonl", "{\"frame\":0,\"site\":1,\"level\":-3}\n"),
             {"touches.jsonl: line 1", "negative"}));
  CHECK(says(result_refusal("live.json", "{\"processed\":[]}"), {"live.json", "no frame"}));
  CHECK(says(result_refusal("touches.jsonl", "{\"frame\":0,\"site\":\"nose\"}\n"),
             {"touches.jsonl: line 1"}));
  CHECK(says(
      result_refusal("pose.jsonl",
                     "{\"frame\":0,\"camera_from_body\":[2,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}"),
      {"pose.jsonl: line 1", "no rigid motion"}));
  CHECK(says(
      result_refusal("pose.jsonl",
                     "{\"frame\":0,\"camera_from_body\":[1,0,0,0, 0,1,0,0, 0,0,-1,0, 0,0,0,1]}"),
      {"pose.jsonl: line 1", "no rigid motion"}));
  CHECK(says(result_refusal("rectification.jsonl", "{\"frame\":0,\"row_correction_px\":null}\n"),
             {"rectification.jsonl: line 1"}));
  CHECK(says(result_refusal("live.json", "{\"processed\":[0,\n\n"), {"live.json: no JSON at"}));
  CHECK(says(result_refusal("live.json", "{\"processed\":[0,1.5]}"), {"live.json", "1.5 is no"}));
  CHECK(says(result_refusal("live.json", "{\"processed\":2}"), {"live.json", "no list"}));
  CHECK(says(result_refusal("live.json", "[1]"), {"live.json"}));
  CHECK(says(result_refusal("touches.jsonl", "{\"frame\":0.5}\n"),
             {"touches.jsonl: line 1", "0.5 is no"}));
  CHECK(says(result_refusal("trajectory.txt", "0 0 0 x 0 0 0 1\n"), {"trajectory.txt: line 1"}));
}

TEST_CASE("missing or empty folders are refused by name", "[scorecard][errors]") {
  const ScratchFolder folder("scorecard");
  CHECK(says(refusal([&] { (void)read_truth_folder(folder / "nowhere"); }), {"nowhere"}));
  CHECK(says(refusal([&] { (void)read_truth_folder(folder.path()); }), {"camera.toml is missing"}));
  write(folder / "camera.toml", kCamera);
  CHECK(says(refusal([&] { (void)read_truth_folder(folder.path()); }), {"holds no frame"}));
  CHECK(says(refusal([&] { (void)read_result_folder(folder / "nowhere", 1); }), {"nowhere"}));
  CHECK(says(refusal([&] { (void)read_result_folder(folder.path(), 1); }),
             {"none of the files of a result"}));
}

TEST_CASE("a missing score is null in JSON and a dash in text", "[scorecard]") {
  Scorecard scores;
  scores.frames = 3;
  scores.frames_processed = 3;
  CHECK(json_of(scores) == R"({
  "frames": 3,
  "frames_processed": 3,
  "depth_frames": 0,
  "depth_median": null,
  "depth_within_1pct": null,
  "depth_density": null,
  "hand_within_1pct": null,
  "hand_near_frames": null,
  "too_close_called_far": null,
  "moving_iou": null,
  "moving_recall": null,
  "moving_false": null,
  "occlusion_frames": 0,
  "occlusion_iou": null,
  "occlusion_iou_where_hidden": null,
  "occlusion_iou_worst_frame": null,
  "edge_error_px": null,
  "crossing_frames": 0,
  "edge_error_crossing_px": null,
  "flicker": null,
  "ate_mm": null,
  "rpe_mm": null,
  "rpe_deg": null,
  "trajectory_share": null,
  "frames_touching": null,
  "touch_precision": null,
  "touch_recall": null,
  "touch_site": null,
  "first_touch_delay_frames": null,
  "touch_recall_3mm": null,
  "touch_false_5mm": null,
  "frames_too_deep": null,
  "frames_unseen": null,
  "penetration_median_mm": null,
  "penetration_p99_mm": null,
  "penetration_median_mm_unseen": null,
  "largest_pop_mm": null,
  "largest_pop_frame": null,
  "pops_4mm": null,
  "deformed_frames": null,
  "deformed_frames_shallow": null,
  "deformed_frames_unseen": null,
  "displacement_error": null,
  "displacement_error_mm": null,
  "displacement_error_mm_shallow": null,
  "displacement_error_mm_unseen": null,
  "von_mises_error": null,
  "force_error": null,
  "overpress_mm": null,
  "deformed_by_frame": null,
  "placement_error_mm": null,
  "jitter_mm": null,
  "row_error_px": null
})");
  const std::string text = text_of(scores);
  CHECK(text.starts_with("frames                                      3\n"));
  CHECK(text.find("jitter of the body in the world             -\n") != std::string::npos);
  CHECK(text.find("depth at (m)") == std::string::npos);
}

TEST_CASE("scores are listed with their units, depth by distance", "[scorecard]") {
  Scorecard scores;
  scores.images.depth_frames = 1;
  scores.images.depth.near_frames = 0;
  scores.images.depth.at[2].median_error = 0.0123;
  scores.images.depth.at[2].within_1pct = 0.5;
  scores.body.first_touch_delay_frames = -2;
  scores.jitter_mm = 1.25;
  scores.reduction_error = 0.00123;
  scores.reduction_error_worst = 0.5;
  const std::string text = text_of(scores);
  const auto in_text = [&](const char* part) { return text.find(part) != std::string::npos; };
  CHECK(in_text("\n         0.5           1.23 %       50.0 %\n"));
  CHECK_FALSE(in_text("\n         0.3 "));
  CHECK(in_text("\nfirst touch felt after the true one by      -2 frames\n"));
  CHECK(in_text("\njitter of the body in the world             1.25 mm\n"));
  CHECK(in_text("\nerror of the reduced model, pooled          1.23e-03\n"));
  const std::string json = json_of(scores);
  CHECK(json.find("\"hand_near_frames\": 0") != std::string::npos);
  CHECK(json.find("\"0.5\": 0.0123") != std::string::npos);
  CHECK(json.find("\"15\": null") != std::string::npos);
  CHECK(json.ends_with("\"reduction_error\": 0.00123,\n  \"reduction_error_worst\": 0.5\n}"));
}

}  // namespace
}  // namespace palpable
