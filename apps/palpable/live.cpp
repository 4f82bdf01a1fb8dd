// palpable live: presses bodies by what a camera sees.

#include "apps/common/command_line.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/default_body.h"
#include "apps/palpable/live_changes.h"
#include "apps/palpable/live_play.h"
#include "apps/palpable/live_setup.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/live/sources/recording_file.h"

#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

struct Options {
  LiveOptions live;
  PlayOptions play;
  fs::path record;  // empty: no recording
};

// Fails before bodies are read if the recording cannot be written.
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

void live(const Options& options) {
  LiveOptions wanted = options.live;
  check_recording(options);
  LivePlay play(options.play, inputs_of(wanted), options.record);
  if (!options.play.out.empty()) wanted.clip = options.play.out / "clip";
  share_drawing_threads(wanted.threads);
  LiveSetUp setup = set_up_live(wanted);
  play.check(setup);  // before an earlier recording is replaced
  LiveChanges changes(wanted, setup);
  if (!options.record.empty()) changes.begin_recording(options.record);
  const bool may_change = LiveChanges::possible(wanted, options.play);
  play.play(setup, wanted.frames, wanted.scene, changes.watch(), may_change ? &changes : nullptr);
  changes.report();
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
      "Example: palpable live post --source synthetic --out out\n"
      "Example: palpable live --scene scenes/beams.toml --source clip/frames --out out\n"
      "Example: palpable live bunny.palpable --source desk --place \"0 0.1 0.6 0 40 0\" "
      "--out out\n"
      "Example: palpable live bunny.palpable --source /dev/video0 --calibration SN10027514.conf "
      "--place \"0 0.1 0.6 0 40 0\" --window\n"
      "Example: palpable live bunny.palpable --source /dev/video0 --anchor plane --window --out "
      "out\n"
      "Example: palpable live bunny.palpable --source /dev/video0 --anchor plane --window "
      "--record touch.palprec");
  command.callback([options] {
    options->live.body = find_body(options->live.body);
    live(*options);
  });
}

}  // namespace palpable::app
