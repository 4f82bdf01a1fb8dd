#include "palpable/live/play/live_play.h"

#include "palpable/common/base/error.h"
#include "palpable/common/body_file/body_file.h"
#include "palpable/live/sources/recording_file.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/misbehaving_camera.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using Catch::Matchers::Contains;
using test::Act;

// A run of a sphere's file before a camera that shows a finger, which enters it more and more.
LiveSetUp set_up_sphere(const fs::path& file, const std::vector<Act>& acts) {
  write_body_file(file, test::DentedSphere{}.body());
  Rigid3 pose = Rigid3::Identity();
  pose.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  pose.translation() = Eigen::Vector3d(0, 0.05, 0.4);
  RunOptions options;
  options.contact = "site";
  options.fixed_camera = options.press_static = true;
  const DescribedBody body{.file = file};
  std::vector<PlacedBody> bodies;
  bodies.push_back({read_live_body(body, options.contact), pose});
  return {.run = run_of(std::move(bodies), std::make_unique<test::MisbehavingCamera>(acts),
                        session_settings(options), "a camera"),
          .bodies = {body},
          .options = options};
}

// A user who notes what is said, and ends the run after some frames.
struct Listener {
  std::string printed;
  std::vector<std::string> said;
  int begun = 0;
  int frames = 0, last = -1;  // shown; the number after which the run is to end, -1: none

  PlayUser user() {
    return {.print = [this](const std::string& text) { printed += text; },
            .say = [this](const std::string& line) { said.push_back(line); },
            .progress = [this](const ProgressReport&) { ++frames; },
            .begin = [this] { ++begun; },
            .asked_to_end = [this] { return frames == last; }};
  }
};

// The line "states: ..." of a summary.
std::string states_in(const std::string& text) {
  const std::size_t begin = text.find("states: ");
  return begin == std::string::npos ? "" : text.substr(begin, text.find('\n', begin) - begin);
}

TEST_CASE("a run is played to its end, and its summary is returned", "[play]") {
  const test::ScratchFolder folder("live_play");
  std::vector<Act> acts(20, Act::kGood);
  acts[4] = Act::kGarbage;
  LiveSetUp setup = set_up_sphere(folder / "sphere.palpable", acts);
  Listener listener;
  LivePlay play({}, {}, listener.user());
  const PlayResult result = play.play(setup, 20);
  CHECK_FALSE(result.user_ended);
  CHECK_THAT(result.text, Catch::StartsWith("19 frames in ") && Contains(", 1 unreadable\n") &&
                              Contains("\ntouched in "));
  CHECK(states_in(result.text).empty());  // neither recorded nor replayed
  CHECK(listener.begun == 1);
  CHECK(listener.frames == 19);
  CHECK(listener.printed.empty());
}

TEST_CASE("a run ends when its user asks for it", "[play]") {
  const test::ScratchFolder folder("live_play_ended");
  LiveSetUp setup = set_up_sphere(folder / "sphere.palpable", std::vector<Act>(50, Act::kGood));
  Listener listener;
  listener.last = 6;
  LivePlay play({}, {}, listener.user());
  const PlayResult result = play.play(setup, 50);
  CHECK(result.user_ended);
  CHECK_THAT(result.text, Catch::StartsWith("6 frames in "));
}

TEST_CASE("a run in which no frame can be read fails", "[play][refusal]") {
  const test::ScratchFolder folder("live_play_nothing");
  LiveSetUp setup = set_up_sphere(folder / "sphere.palpable", std::vector<Act>(3, Act::kGarbage));
  Listener listener;
  LivePlay play({}, {}, listener.user());
  CHECK_THROWS_WITH(play.play(setup),
                    "a camera: no frame could be read (3 unreadable; the picture is cut off)");
}

TEST_CASE("a recorded run is replayed to the same states", "[play][recording]") {
  const test::ScratchFolder folder("live_play_recorded");
  const fs::path file = folder / "touch.palprec";
  std::string live_states;
  {
    LiveSetUp setup = set_up_sphere(folder / "sphere.palpable", std::vector<Act>(300, Act::kGood));
    Listener listener;
    LivePlay play({}, {}, listener.user(), file);
    const PlayResult result = play.play(setup, 12);
    CHECK(listener.printed == "recording " + file.string() + ": it holds pictures of your room\n");
    live_states = states_in(result.text);
    CHECK_THAT(live_states, Catch::EndsWith(" of 12 frames"));
    CHECK_THAT(result.text, Catch::EndsWith("palpable replay plays it\n"));
  }
  RecordingContents contents = value_or_throw(read_recording(file));
  RecordedRun run = recorded_run_of(contents.run);
  find_body_files(run, {});
  const auto replay = [&](StateComparison& comparison) {
    LiveSetUp setup = set_up_replay(run, file, 2, false);
    Listener listener;
    LivePlay play({}, {file}, listener.user());
    return play.replay(setup, comparison);
  };
  StateComparison equal(contents.states);
  CHECK(states_in(replay(equal).text) == live_states);
  CHECK(equal.compared() == 12);
  CHECK_FALSE(equal.first_different());

  contents.states[5].hash ^= 1;
  StateComparison different(contents.states);
  CHECK(states_in(replay(different).text) == live_states);
  CHECK(different.different() == 1);
  CHECK(different.first_different() == contents.states[5].number);
}

TEST_CASE("options that contradict each other or the bodies are refused before anything is played",
          "[play][refusal]") {
  const test::ScratchFolder folder("live_play_refused");
  Listener listener;
  const auto begin = [&](const PlayOptions& options, const fs::path& record = {}) {
    LivePlay play(options, {folder / "body.palpable"}, listener.user(), record);
  };
  CHECK_NOTHROW(begin({}));
  CHECK_THROWS_WITH(begin({.files = {.meshes = true}}),
                    "--write: without --out nothing is written");
  CHECK_THROWS_WITH(begin({.overwrite = true}), "--overwrite: without --out nothing is written");
  CHECK_THROWS_WITH(begin({.paused = true}), "--paused: a --window is paused");
  CHECK_THROWS_WITH(begin({.view = {"camera", "map"}}),
                    "--view with several views: without --out nothing is written");
  // A page shows them: what is missing is its bundle.
  CHECK_THROWS_WITH(
      begin({.serve = LivePageSettings{0, folder / "none"}, .view = {"camera", "map"}}),
      Catch::StartsWith("--serve: "));
  CHECK_THROWS_WITH(begin({.out = folder / "out", .view = {"map"}, .files = {.stills = true}}),
                    "--write stills: they are what the camera sees; leave out --view map");
  for (const std::vector<std::string>& tiles :
       {std::vector<std::string>{"camera", "map"}, {"mask"}}) {
    CHECK_THROWS_WITH(begin({.view = tiles, .window = true}),
                      "--view: the --window shows one view, and switches it");
  }
  CHECK_THROWS_WITH(begin({}, folder / "touch.mp4"), Contains("should end in .palprec"));
  const fs::path there = folder / "there.palprec";
  test::write_bytes(there, "PALPREC\nan earlier one");
  CHECK_THROWS_WITH(begin({}, there), Contains("is there already; --overwrite replaces it"));
  CHECK_NOTHROW(begin({.overwrite = true}, there));
  test::write_bytes(there, "my notes");
  CHECK_THROWS_WITH(begin({.overwrite = true}, there),
                    Contains("is no recording") && Contains("somebody's"));

  LiveSetUp setup = set_up_sphere(folder / "sphere.palpable", {Act::kGood});
  LivePlay contact({.paint = "contact"}, {}, listener.user(), there.parent_path() / "new.palprec");
  CHECK_THROWS_WITH(contact.play(setup), Contains("is pressed at its sites here"));
  CHECK_FALSE(fs::exists(folder / "new.palprec"));  // no recording was begun
  LivePlay ticks({.contact_rate = 1000}, {}, listener.user());
  CHECK_THROWS_WITH(ticks.play(setup), Catch::StartsWith("--contact-rate: "));
}

}  // namespace
}  // namespace palpable
