// palpable replay: processes a recording again and checks that the results are the same.

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/live_options.h"
#include "apps/palpable/live_settings.h"
#include "apps/palpable/terminal.h"
#include "palpable/common/base/error.h"
#include "palpable/live/player/state_hash.h"
#include "palpable/live/sources/recording_file.h"

#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

struct ReplayOptions {
  fs::path file;
  std::vector<std::string> bodies;  // their present paths
  int threads = 0;                  // 0: the default
  bool paced = false;
  bool json = false;
  PlayOptions play;
};

RecordedRun run_of_recording(const ReplayOptions& options, const RecordingContents& contents) {
  try {
    RecordedRun run = recorded_run_of(contents.run);
    find_body_files(run, options.bodies);
    return run;
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", options.file.string(), error.what()));
  }
}

// Prints the comparison. @throws Error at a difference
void report(const ReplayOptions& options, const RecordingContents& contents,
            const StateComparison& comparison, const RecordedRun& run, bool user_ended) {
  const std::string file = options.file.string();
  if (const auto frame = comparison.first_different()) {
    throw Error(fmt::format(
        "{}: of {} states {} differ from the live run's, that of frame {} first{}", file,
        comparison.compared(), comparison.different(), *frame,
        run.version == PALPABLE_VERSION ? ""
                                        : fmt::format("; it was recorded by version {}, this is {}",
                                                      run.version, PALPABLE_VERSION)));
  }
  print_text("{} of {} states of the live run: equal\n", comparison.compared(),
             comparison.expected());
  if (contents.damaged || (comparison.compared() < comparison.expected() && !user_ended)) {
    throw Error(fmt::format("{}: {}", file,
                            contents.damaged ? contents.ending + "; it was played up to there"
                                             : "is damaged; it was played up to there"));
  }
  if (!contents.ending.empty()) print_text("{} {}\n", file, contents.ending);
}

void replay(const ReplayOptions& options) {
  const RecordingContents contents = value_or_throw(read_recording(options.file));
  const RecordedRun run = run_of_recording(options, contents);
  share_drawing_threads(options.threads);
  std::vector<fs::path> inputs{options.file};
  for (const RecordedRun::Body& body : run.bodies) inputs.push_back(body.body.file);
  PlayOptions how = options.play;
  how.paced = options.paced;
  ProgressBar bar;
  LivePlay play(how, inputs, user_at(bar));
  LiveSetUp setup = set_up_replay(run, options.file, options.threads, options.paced);
  StateComparison comparison(contents.states);
  const PlayResult result = play.replay(setup, comparison);
  bar.finish();
  print_text("{}", result.text);
  if (options.json) {
    Json summary = result.summary;
    summary["states_compared"] = comparison.compared();
    summary["states_different"] = comparison.different();
    print_json(summary);
  }
  report(options, contents, comparison, run, result.user_ended);
}

}  // namespace

void add_replay(Command app) {
  auto options = std::make_shared<ReplayOptions>();
  Command command = app.add_subcommand(
      "replay", "Process a recorded run again, and check that it gives the same states");
  command.begin_group("Input");
  command.add_option("recording", options->file, "What palpable live --record has written")
      .required();
  command
      .add_option("--body", options->bodies,
                  "Where the body files are now; each is recognised by its checksum")
      .type_name("FILE")
      .default_is("where they were");
  add_play_options(command, options->play);
  command.begin_group("Files");
  command.add_json(options->json);
  command.begin_expert_group("Loop");
  add_threads(command, options->threads,
              "Threads that the run may keep busy at a time; the states do not depend on it");
  command.add_flag("--paced", options->paced,
                   "At the pace at which it was recorded, or slower: no frame is left out");
  command.footer(
      "Prints the same line 'states: ...' as the live run did. Exit code 1 where a state differs, "
      "which names the first such frame, or where the file is damaged; one that was cut off is "
      "played up to there.\n"
      "Example: palpable replay touch.palprec\n"
      "Example: palpable replay touch.palprec --paced --window --out out");
  command.callback([options] { replay(*options); });
}

}  // namespace palpable::app
