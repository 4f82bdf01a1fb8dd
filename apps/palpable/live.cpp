// palpable live: presses bodies by what a camera sees.

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/installed.h"
#include "apps/palpable/live_options.h"
#include "apps/palpable/live_settings.h"
#include "apps/palpable/terminal.h"

#include <fmt/core.h>

#include <filesystem>
#include <memory>

namespace palpable::app {
namespace {

struct Options {
  LiveOptions live;
  PlayOptions play;
  std::filesystem::path record;  // empty: no recording
};

void live(const Options& options) {
  LiveOptions wanted = options.live;
  ProgressBar bar;
  LivePlay play(options.play, inputs_of(wanted), user_at(bar), options.record);
  if (!options.play.out.empty()) wanted.clip = options.play.out / "clip";
  share_drawing_threads(wanted.threads);
  LiveSetUp setup = set_up_live(wanted);
  const PlayResult result = play.play(setup, wanted.frames);
  bar.finish();
  fmt::print("{}", result.text);
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
