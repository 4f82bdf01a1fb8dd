#include "palpable/live/play/live_changes.h"

#include "palpable/common/base/error.h"
#include "palpable/common/body_file/body_file.h"
#include "palpable/live/player/live_loop.h"
#include "palpable/live/sources/recording_file.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/misbehaving_camera.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using test::Act;

// A run whose user may change it, drawn off screen.
struct ChangedRun {
  explicit ChangedRun(const fs::path& file) {
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
    auto camera = std::make_unique<test::MisbehavingCamera>(std::vector<Act>(400, Act::kGood));
    setup.emplace(LiveSetUp{
        .run = run_of(std::move(bodies), std::move(camera), session_settings(options), "a camera"),
        .bodies = {body},
        .settings = {.place = pose},
        .options = options});
    user = {.print = [this](const std::string& text) { printed += text; },
            .say = [](const std::string&) {}};
    changes.emplace(*setup, user);
    try {
      painter.emplace(ScenePainterSettings{.run_may_change = true}, setup->run.loop);
    } catch (const Error&) {}  // no OpenGL
  }

  std::optional<LiveSetUp> setup;
  std::string printed;
  PlayUser user;
  std::optional<LiveChanges> changes;
  std::optional<ScenePainter> painter;
};

TEST_CASE("a run that begins anew has its bodies where they stood at first", "[play][pixels]") {
  const test::ScratchFolder folder("live_changes_anew");
  ChangedRun run(folder / "sphere.palpable");
  if (!run.painter) PALPABLE_SKIP("no OpenGL");
  LiveControls& controls = run.painter->controls();
  const Session& session = run.setup->run.loop.session;
  const Rigid3 first = session.body().world_from_body;
  LiveLoop loop(run.setup->run);
  Scene* scene = nullptr;
  for (int frame = 0; frame < 20; ++frame) scene = loop.next();
  REQUIRE(scene != nullptr);
  REQUIRE_FALSE(scene->touches.empty());
  CHECK_FALSE(run.changes->apply(*run.painter, *scene));  // no wish

  controls.wishes.place = Eigen::Vector2d(0, 0);  // nothing is seen there
  CHECK_FALSE(run.changes->apply(*run.painter, *scene));
  CHECK(run.painter->panel().note == "no surface is known there: click beside it");
  CHECK(controls.placing);
  CHECK_FALSE(controls.wishes.of_frame());

  controls.wishes.anew = true;
  CHECK(run.changes->apply(*run.painter, *scene));
  CHECK(run.painter->panel().note.empty());
  CHECK(session.body().world_from_body.isApprox(first));
  CHECK(scene->bodies.front().camera_from_body.isApprox(first));
}

TEST_CASE("a recording that the user begins and ends can be replayed",
          "[play][pixels][recording]") {
  const test::ScratchFolder folder("live_changes_record");
  const fs::path before = fs::current_path();
  fs::current_path(folder.path());
  ChangedRun run("sphere.palpable");
  if (!run.painter) {
    fs::current_path(before);
    PALPABLE_SKIP("no OpenGL");
  }
  LiveControls& controls = run.painter->controls();
  LiveLoop loop(run.setup->run);
  const auto answer = [&](int frames) {
    for (int frame = 0; frame < frames; ++frame) {
      Scene* scene = loop.next();
      REQUIRE(scene != nullptr);
      CHECK_FALSE(run.changes->add(*scene));
    }
  };
  controls.wishes.recording = true;
  CHECK_FALSE(run.changes->record(*run.painter, loop));  // no frame yet
  answer(5);
  controls.wishes.recording = true;
  CHECK(run.changes->record(*run.painter, loop));
  const std::string file = run.painter->panel().recording;
  CHECK(run.printed == "recording " + file + ": it holds pictures of your room\n");
  answer(6);
  controls.wishes.recording = true;
  CHECK_FALSE(run.changes->record(*run.painter, loop));
  CHECK(run.painter->panel().note == file + " is written");
  CHECK(run.changes->text().empty());  // it has ended before the run
  CHECK_FALSE(run.changes->end());

  const RecordingContents contents = value_or_throw(read_recording(file));
  CHECK(contents.finished);
  const RecordedRun recorded = recorded_run_of(contents.run);
  LiveSetUp again = set_up_replay(recorded, file, 1, false);
  LivePlay play({}, {},
                {.print = [](const std::string&) {},
                 .say = [](const std::string&) {},
                 .begin = [] {},
                 .asked_to_end = [] { return false; }});
  StateComparison comparison(contents.states);
  (void)play.replay(again, comparison);
  CHECK(comparison.compared() == 6);
  CHECK_FALSE(comparison.first_different());
  fs::current_path(before);
}

}  // namespace
}  // namespace palpable
