// palpable live: presses bodies by what a camera sees.

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/installed.h"
#include "apps/palpable/live_options.h"
#include "apps/palpable/live_settings.h"
#include "apps/palpable/live_things.h"
#include "apps/palpable/scene_options.h"
#include "apps/palpable/terminal.h"
#include "palpable/common/base/error.h"
#include "palpable/live/play/preview.h"

#include <fmt/core.h>

#include <filesystem>
#include <memory>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOwnFolder = "palpable-live";  // of the film of a call without --out

struct Options {
  LiveOptions live;
  PlayOptions play;
  fs::path record;  // empty: no recording
  bool no_window = false;
  bool preview = false;
  bool print_config = false;
  bool json = false;
};

// Whether nothing would come out of the run.
bool is_silent(const Options& options) {
  return options.play.out.empty() && options.record.empty() && options.play.events == kNoEvents &&
         !options.play.serve && !options.play.window && !options.json;
}

// Opens a window where the user asked for nothing else, and a screen is there.
// @param alone  the command was given without any word: without a screen it writes a film
void choose_output(Options& options, bool alone) {
  if (!is_silent(options)) return;
  if (!options.no_window && has_screen()) {
    options.play.window = true;
  } else if (alone) {
    print_note("there is no screen for a window: the film goes to {}/", kOwnFolder);
    options.play.out = kOwnFolder;
    options.play.files = {.depth = false, .masks = false};
    options.play.overwrite = true;
  } else {
    print_note("nothing is shown or written: --window shows it, --out DIR writes the film");
  }
}

void run_preview(const Options& options) {
  const PreviewSettings settings = preview_settings(options.live, options.play);
  ProgressBar bar;
  const PreviewResult result = preview(settings, user_at(bar));
  bar.finish();
  print_text("{}", text_of(result));
  if (options.json) print_json(json_of(result));
}

void live(const Options& options) {
  const LiveOptions& wanted = options.live;
  ProgressBar bar;
  LivePlay play(options.play, inputs_of(wanted), user_at(bar), options.record);
  share_drawing_threads(wanted.threads);
  LiveSetUp setup = set_up_live(wanted);
  const PlayResult result = play.play(setup, wanted.frames);
  bar.finish();
  print_text("{}", result.text);
  if (options.json) print_json(result.summary);
  if (!result.lost.empty()) throw Error(result.lost);
}

// Without a camera: what presses comes as lines.
void live_without_camera(const Options& options) {
  ProgressBar bar;
  ThingsPlay play(
      options.play, inputs_of(options.live), user_at(bar),
      options.live.input.source == kSocketSource ? ThingsFrom::kClient : ThingsFrom::kFile);
  share_drawing_threads(options.live.threads);
  ThingsSetUp setup = set_up_things(options.live);
  setup.paced = setup.paced || options.play.window;  // too fast to be watched otherwise
  const PlayResult result = play.play(setup, options.live.frames);
  bar.finish();
  print_text("{}", result.text);
  if (options.json) print_json(result.summary);
  if (!result.lost.empty()) throw Error(result.lost);
}

// @param command  of these options
void run_command(Command command, Options& options) {
  const bool alone = options.live.body.empty() && command.given_options().empty();
  if (options.live.body.extension() == ".toml") {
    options.live.scene = std::exchange(options.live.body, {});
    command.set_from_file(options_of_scene(options.live.scene));
  } else if (options.live.body.empty()) {
    // A preview has no body.
    if (!options.preview || options.print_config) options.live.body = shipped_body();
  } else {
    options.live.body = find_body(options.live.body);
  }
  refuse_table_source(options.live.input.source);
  const bool has_camera = !is_things_source(options.live.input.source);
  if (!has_camera) refuse_camera_options(options.live, options.play, command.given_options());
  if (options.print_config) {
    if (has_camera) static_cast<void>(given_place(options.live));  // throws if it is no pose
    print_text("{}", scene_file_text(options.live, command.given_options()));
    return;
  }
  if (options.no_window && options.play.window) {
    throw Error("--window and --no-window contradict each other");
  }
  if (!options.play.out.empty()) options.live.clip = options.play.out / "clip";
  choose_output(options, alone);
  if (!has_camera) {
    live_without_camera(options);
  } else if (options.preview) {
    run_preview(options);
  } else {
    live(options);
  }
}

}  // namespace

void add_live(Command app) {
  auto options = std::make_shared<Options>();
  Command command = app.add_subcommand("live", "Press bodies with what a camera sees");
  add_live_options(command, options->live);
  command.begin_group("Camera");
  command.add_flag("--preview", options->preview,
                   "Show the camera's picture, the depth and what moves, without a body: to set a "
                   "camera up");
  add_play_options(command, options->play);
  command.begin_group("Files");
  command
      .add_option("--record", options->record,
                  "Keep all that comes in, for palpable replay or as a --source: pictures of your "
                  "room, without loss, 3 MB for each 720p pair")
      .type_name("FILE.palprec");
  command.add_flag("--print-config", options->print_config,
                   "Print the scene file that this call amounts to, and exit");
  command.add_json(options->json);
  command.begin_expert_group("Display, more");
  command.add_flag("--no-window", options->no_window,
                   "Open no window, also where there is a screen and nothing is written");
  command.footer(
      "Without arguments it plays the built-in desk with the body that ships. A camera that stalls "
      "or goes away does not end the run: the last state is held until pictures come again; Ctrl-C "
      "ends it. docs/benchmark_files.md has the formats of the files.\n"
      "Example: palpable live\n"
      "Example: palpable live bunny.palpable --source /dev/video0 --anchor plane\n"
      "Example: palpable live bunny.palpable --source desk --calibration desk.yml --place \"0 0.1 "
      "0.6 0 40 0\" -o out --write film\n"
      "Example: palpable live two-bodies.toml --source clip/frames --paint pressure -o out\n"
      "Example: palpable live --source /dev/video0 --preview\n"
      "A scene file of two bodies (docs/scenes.md):\n"
      "  [[body]]\n"
      "  name = \"a\"\n"
      "  file = \"bunny.palpable\"\n"
      "  [[body]]\n"
      "  name = \"b\"\n"
      "  file = \"post.palpable\"\n"
      "  at = [\"200 mm\", \"0 mm\", \"0 mm\"]   # from where a scene's bodies stand, z up");
  command.callback([options, command] { run_command(command, *options); });
}

}  // namespace palpable::app
