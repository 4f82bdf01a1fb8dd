// palpable live: images in, the pressed body in them out.

#include "apps/common/command_line.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/live_play.h"
#include "apps/palpable/live_setup.h"
#include "apps/palpable/recorded_run.h"
#include "palpable/base/error.h"
#include "palpable/base/output_file.h"
#include "palpable/events/event_lines.h"
#include "palpable/live/recorder.h"

#include <fmt/core.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

struct Options {
  LiveOptions live;
  PlayOptions play;
  fs::path record;  // empty: nothing is recorded
};

// Before bodies are read: whether the recording can be written.
void check_recording(const Options& options) {
  if (options.record.empty()) return;
  const std::string file = options.record.string();
  if (!is_recording_name(options.record)) {
    throw Error(fmt::format("--record {}: should end in {}", file, kRecordingEnding));
  }
  guard_output_file(options.record, inputs_of(options.live));
  std::error_code ignored;
  if (fs::exists(options.record, ignored) && !options.play.overwrite) {
    throw Error(fmt::format("--record {}: is there already; --overwrite replaces it", file));
  }
}

// One run's recording: its file, and what goes into it.
class Recording {
 public:
  // Begins the file; the run's frames go through it from now on.
  Recording(const Options& options, LiveSetUp& setup)
      : file_(options.record),
        lines_(event_bodies(setup.run.loop.session)),
        recorder_(file_, setup.run.source->format(),
                  json_of_run(recorded_run(options.live, setup))),
        refiner_(setup.run.loop.session.refiner()) {
    setup.run.source = recorded(std::move(setup.run.source), recorder_);
    fmt::print("recording {}: it holds pictures of your room\n", file_.string());
    std::fflush(stdout);
  }

  [[nodiscard]] StateWatch watch() {
    return {[this](const Scene& scene) {
              const bool refines =
                  refiner_ != nullptr && (refiner_->asked() || refiner_->taken_up() != nullptr);
              if (refines) recorder_.add_refinement(refiner_->asked(), refiner_->taken_up());
              recorder_.add_state(scene.number, state_hash(scene), lines_.line_of(scene));
              return recorder_.take_trouble();
            },
            [this]() -> std::optional<LiveSummary::States> {
              counts_ = recorder_.finish();
              return LiveSummary::States{counts_.states.text(), counts_.states.count()};
            }};
  }

  // What became of it.
  void report() {
    if (const auto trouble = recorder_.take_trouble()) fmt::print(stderr, "{}\n", *trouble);
    if (counts_.left_out > 0) {
      fmt::print("{} frames were left out of recording and run: the disk was behind\n",
                 counts_.left_out);
    }
    fmt::print("{}: {} frames, {:.1f} MB, pictures of your room; palpable replay plays it\n",
               file_.string(), counts_.frames, 1e-6 * static_cast<double>(counts_.bytes));
  }

 private:
  fs::path file_;
  EventLines lines_;
  Recorder recorder_;
  const Refiner* refiner_;  // the session's; null: nothing is refined
  RecorderCounts counts_;
};

void live(const Options& options) {
  LiveOptions wanted = options.live;
  check_recording(options);
  LivePlay play(options.play, inputs_of(wanted), options.record);
  if (!options.play.out.empty()) wanted.clip = options.play.out / "clip";
  share_drawing_threads(wanted.threads);
  LiveSetUp setup = set_up_live(wanted);
  play.check(setup);  // before an earlier recording is replaced
  std::optional<Recording> recording;
  if (!options.record.empty()) recording.emplace(options, setup);
  play.play(setup, wanted.frames, wanted.scene, recording ? recording->watch() : StateWatch());
  if (recording) recording->report();
}

}  // namespace

void add_live(Command app) {
  auto options = std::make_shared<Options>();
  Command command =
      app.add_subcommand("live", "Let what a camera saw press bodies: video, figures, timing");
  add_live_options(command, options->live);
  add_play_options(command, options->play);
  command
      .add_option("--record", options->record,
                  "Keep all that comes in, for palpable replay or as a --source: pictures of your "
                  "room, without loss, 3 MB for each 720p pair. Where the disk is behind, a "
                  "camera's frames are left out of the run, too")
      .type_name("FILE.palprec");
  command.footer(
      "With --out it writes touch.mp4, timing.csv, touches.jsonl, trajectory.txt, pose.jsonl, "
      "rectification.jsonl, live.json, depth/, visible/, body_depth/ and moving/ "
      "(docs/benchmark.md has the formats).\n"
      "A recording waits for the loop unless --paced. A camera that stalls or goes away does not "
      "end the run: the last state is held until pictures come again; Ctrl-C ends it.\n"
      "Example: palpable live bunny.palpable --source synthetic --out out\n"
      "Example: palpable live --scene scenes/beams.toml --source clip/frames --out out\n"
      "Example: palpable live bunny.palpable --source desk --place \"0 0.1 0.6 0 40 0\" "
      "--out out\n"
      "Example: palpable live bunny.palpable --source /dev/video0 --calibration SN10027514.conf "
      "--place \"0 0.1 0.6 0 40 0\" --window\n"
      "Example: palpable live bunny.palpable --source /dev/video0 --anchor plane --window --out "
      "out\n"
      "Example: palpable live bunny.palpable --source /dev/video0 --anchor plane --window "
      "--record touch.palprec");
  command.callback([options] { live(*options); });
}

}  // namespace palpable::app
