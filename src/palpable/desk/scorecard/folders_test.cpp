#include "palpable/desk/scorecard/folders.h"

#include "palpable/common/base/error.h"
#include "palpable/desk/scorecard/figures.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <fstream>
#include <string>
#include <vector>

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
  CHECK(json_of(scores)["bodies"]["upper"]["touch_recall"].get<double>() == 1.0);
  CHECK(json_of(scores)["bodies"]["lower"]["touch_recall"].is_null());
  CHECK(text_of(scores).find("\n== upper\n") != std::string::npos);
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
  scores.truth = "clip/truth";
  scores.result = "out";
  scores.frames = 3;
  scores.frames_processed = 3;
  const Json json = json_of(scores);
  std::vector<std::string> known;
  for (const auto& [key, value] : json.items()) {
    if (!value.is_null()) known.push_back(key);
  }
  CHECK(known == std::vector<std::string>{"frames", "frames_processed", "occlusion_frames",
                                          "crossing_frames", "depth_frames"});
  CHECK(json.items().size() == 59);
  CHECK(json["touch_recall"].is_null());
  CHECK(json["errors_by_frame"].is_null());
  CHECK(json["unseen"].is_null());
  const std::string text = text_of(scores);
  CHECK(
      text.starts_with("compared: out with the truth in clip/truth, 3 of 3 frames processed\n"
                       "accuracy: no touch, picture or path to judge\n"
                       "speed:    not stated by the result\n"));
  CHECK(text.find("\nwhat moves: -, truth or result lacks the files for it\n") !=
        std::string::npos);
  CHECK(text.find("target") == std::string::npos);
  CHECK(text.find("at a distance of") == std::string::npos);
}

// The line of a score's text that holds `what`; empty without one.
std::string line_with(const std::string& text, const std::string& what) {
  const std::size_t at = text.find(what);
  if (at == std::string::npos) return {};
  const std::size_t begin = text.rfind('\n', at) + 1;
  return text.substr(begin, text.find('\n', at) - begin);
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
  CHECK(says(line_with(text, "0.5 m"), {"1.23 %", "50.0 %"}));
  CHECK(text.find(" 0.3 m") == std::string::npos);
  CHECK(line_with(text, "delay of the first touch").ends_with(" -2 frames"));
  CHECK(line_with(text, "jitter of the body").ends_with(" 1.25 mm"));
  CHECK(says(line_with(text, "pooled; worst snapshot"), {"0.123 %", "50.000 %"}));
  // The paper's camera is no target of a synthetic film.
  CHECK(text.find("paper") == std::string::npos);
  const Json json = json_of(scores);
  CHECK(json["hand_near_frames"].get<int>() == 0);
  CHECK(json["depth_error_median"]["0.5"].get<double>() == 0.0123);
  CHECK(json["depth_error_median"]["15"].is_null());
  CHECK(json["reduction_error_worst"].get<double>() == 0.5);
}

TEST_CASE("touches that no camera sees have the same figures in a group of their own",
          "[scorecard]") {
  Scorecard scores;
  scores.body.reference_frames = 0;
  scores.body.unseen.emplace();
  scores.body.unseen->frames = 2;
  scores.body.unseen->displacement_error = MedianAndP90{0.5, 0.75};
  scores.body.unseen->by_frame.resize(2);
  scores.body.unseen->by_frame[1].frame = 8;
  scores.body.unseen->by_frame[1].displacement_error = 0.75;
  const Json json = json_of(scores)["unseen"];
  CHECK(json["frames"].get<int>() == 2);
  CHECK(json["displacement_error"]["p90"].get<double>() == 0.75);
  CHECK(json["force_error"].is_null());
  CHECK(json["errors_by_frame"][1]["frame"].get<int>() == 8);
  CHECK(json["errors_by_frame"][1]["displacement_error"].get<double>() == 0.75);
  CHECK(json_of(scores)["displacement_error"].is_null());
  const std::string text = text_of(scores);
  CHECK(line_with(text, "of these at least 4 mm deep").ends_with(" 2"));
  CHECK(says(line_with(text, "their displacement, relative error"), {"50.0 %", "75.0 %"}));
  CHECK(text.find("target") == std::string::npos);  // the project states none for them
}

// A run on a film with touches, all of whose scores are good enough but the penetration at worst.
Scorecard nearly_good(const std::string& film) {
  Scorecard scores;
  scores.truth = "clip/truth";
  scores.result = "out";
  scores.film = film;
  scores.frames = 600;
  scores.frames_processed = 590;
  scores.speed.frames_per_second = 38.25;
  scores.speed.cpu_ms_per_frame = 36.4;
  scores.speed.age_p50_ms = 41;
  scores.speed.age_p99_ms = 66;
  scores.speed.dropped = 2;
  scores.body.touch_recall = 0.99;
  scores.body.touch_precision = 1;
  scores.body.penetration_median_mm = 0.6;
  scores.body.penetration_p99_mm = 3.01;
  scores.body.reference_frames = 19;
  scores.body.displacement_error = MedianAndP90{0.15, 0.22};
  scores.body.force_error = MedianAndP90{0.12, 0.50};
  return scores;
}

TEST_CASE("three lines say what was compared, how good it is and how fast it was", "[scorecard]") {
  CHECK(text_of(nearly_good("press"))
            .starts_with("compared: out with the truth in clip/truth (film press), 590 of 600 "
                         "frames processed\n"
                         "accuracy: shape off by 15 % in the median (22 % in 9 of 10), force by "
                         "12 % (50 %), against full finite elements (19 frames); touch recall "
                         "0.99, precision 1.00; 5 of 6 targets met\n"
                         "speed:    38.2 frames/s, 36.4 ms of CPU per frame, picture shown after "
                         "41 ms in the median (66 ms in 99 of 100), 2 frames dropped\n"));
}

TEST_CASE("a figure with a target has a verdict beside it", "[scorecard]") {
  const std::string text = text_of(nearly_good("press"));
  CHECK(line_with(text, "penetration of the hand")
            .ends_with(" 3.01 mm   missed (target: at most 1 mm, at most 3 mm at worst)"));
  CHECK(line_with(text, "displacement, relative error")
            .ends_with("   ok (target: at most 20 %, at most 45 % at worst)"));
  // A value that equals its target is good enough.
  CHECK(line_with(text, "force, relative error")
            .ends_with("   ok (target: at most 25 %, at most 50 % at worst)"));
  CHECK(line_with(text, "precision: felt touches").ends_with(" 1.000"));  // without a target
  Scorecard missed = nearly_good("press");
  missed.body.touch_recall_3mm = 0.979;
  CHECK(line_with(text_of(missed), "recall of those").ends_with(" missed (target: at least 0.98)"));
  missed.body.touch_recall_3mm = 0.98;
  CHECK(line_with(text_of(missed), "recall of those").ends_with(" ok (target: at least 0.98)"));
}

TEST_CASE("targets are those stated for the film", "[scorecard]") {
  CHECK(text_of(nearly_good("pencil")).find("target") == std::string::npos);
  CHECK(text_of(nearly_good("pencil-turn")).find("target") == std::string::npos);
  CHECK(says(line_with(text_of(nearly_good("beams")), "displacement, relative error"),
             {"missed (target: at most 6 %, at most 12 % at worst)"}));
  Scorecard walk;
  walk.path.ate_mm = 2.6;
  CHECK(line_with(text_of(walk), "absolute trajectory error").ends_with("2.60 mm"));
  walk.film = "walk";
  CHECK(says(line_with(text_of(walk), "absolute trajectory error"), {"missed", "2.5 mm"}));
  walk.film = "walk-hand";
  CHECK(says(line_with(text_of(walk), "absolute trajectory error"), {"ok", "at most 3 mm"}));
}

}  // namespace
}  // namespace palpable
