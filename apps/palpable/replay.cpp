// palpable replay: processes a recording again and checks that the results are the same.

#include "apps/common/command_line.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/live_play.h"
#include "apps/palpable/recorded_run.h"
#include "palpable/common/base/error.h"
#include "palpable/live/player/live_run.h"
#include "palpable/live/player/state_hash.h"
#include "palpable/live/sources/paced_source.h"
#include "palpable/live/sources/recording_file.h"

#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

struct ReplayOptions {
  fs::path file;
  std::vector<std::string> bodies;  // their present paths
  int threads = 0;                  // 0: the default
  bool paced = false;
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

// Repeats the recorded behaviour of the live run's refiner, without starting a process.
Refiner recorded_refiner(const fs::path& file) {
  // Shared, because std::function must be copyable; there is no other owner.
  const auto recorded =
      std::make_shared<RecordedRefinements>(value_or_throw(RecordedRefinements::open(file)));
  return Refiner::repeating([recorded](int n, RefinerStep& step) {
    RecordedRefinement refinement;
    recorded->read(n, refinement);
    step.asked = refinement.asked;
    step.exact.swap(refinement.exact);
  });
}

LiveSetUp set_up_replay(const ReplayOptions& options, const RecordedRun& run) {
  std::vector<PlacedBody> standing;
  std::vector<DescribedBody> bodies;
  for (const RecordedRun::Body& recorded : run.bodies) {
    TouchableBody body = read_live_body(recorded.body, run.options.contact);
    if (recorded.body.scale != 1) body = scaled(body, recorded.body.scale);
    standing.push_back(
        {std::move(body), recorded.world_from_body, recorded.body.name, recorded.body.color});
    bodies.push_back(recorded.body);
  }
  std::unique_ptr<FrameSource> source = value_or_throw(open_recording(options.file));
  if (options.paced) source = paced(std::move(source), system_clock(), Late::kKept);
  SessionSettings settings = session_settings(run.options);
  share_threads(options.threads, settings);
  LiveSetUp setup{palpable::run_of(std::move(standing), std::move(source), settings, options.file),
                  std::move(bodies)};
  if (!run.options.refine.empty()) {
    setup.run.loop.session.refine_with(recorded_refiner(options.file));
  }
  return setup;
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
  fmt::print("{} of {} states of the live run: equal\n", comparison.compared(),
             comparison.expected());
  if (contents.damaged || (comparison.compared() < comparison.expected() && !user_ended)) {
    throw Error(fmt::format("{}: {}", file,
                            contents.damaged ? contents.ending + "; it was played up to there"
                                             : "is damaged; it was played up to there"));
  }
  if (!contents.ending.empty()) fmt::print("{} {}\n", file, contents.ending);
}

void replay(const ReplayOptions& options) {
  RecordingContents contents = value_or_throw(read_recording(options.file));
  const RecordedRun run = run_of_recording(options, contents);
  share_drawing_threads(options.threads);
  std::vector<fs::path> inputs{options.file};
  for (const RecordedRun::Body& body : run.bodies) inputs.push_back(body.body.file);
  PlayOptions how = options.play;
  how.paced = options.paced;
  LivePlay play(how, inputs);
  LiveSetUp setup = set_up_replay(options, run);
  StateComparison comparison(contents.states);
  RunHash hash;
  const StateWatch watch{[&](const Scene& scene) -> std::optional<std::string> {
                           const std::uint64_t state = state_hash(scene);
                           hash.add(state);
                           comparison.add(scene.number, state);
                           return std::nullopt;
                         },
                         [&]() -> std::optional<LiveSummary::States> {
                           return LiveSummary::States{hash.text(), hash.count()};
                         }};
  // Frames after the last processed one are in the recording, too, but are not replayed.
  const int frames = contents.states.empty() ? -1 : comparison.expected();
  const bool user_ended = play.play(setup, frames, run.scene, watch);
  report(options, contents, comparison, run, user_ended);
}

}  // namespace

void add_replay(Command app) {
  auto options = std::make_shared<ReplayOptions>();
  Command command = app.add_subcommand(
      "replay", "Answer a recorded run again, and say whether it gives the same states");
  command.add_option("recording", options->file, "What palpable live --record has written")
      .required();
  command
      .add_option("--body", options->bodies,
                  "Where files of bodies are now, if not where they were; which is whose is known "
                  "by their checksums")
      .type_name("FILE...");
  command
      .add_option("--threads", options->threads,
                  "How many the run may keep busy at a time; the states do not depend on it. "
                  "Default: as many as there are processors")
      .in_range(1, 64);
  command.add_flag("--paced", options->paced,
                   "At the pace at which it was recorded, or slower: no frame is left out");
  add_play_options(command, options->play);
  command.footer(
      "Prints the same line 'states: ...' as the live run did. Exit code 1 where a state differs, "
      "which names the first such frame, or where the file is damaged; one that was cut off is "
      "played up to there.\n"
      "Example: palpable replay touch.palprec\n"
      "Example: palpable replay touch.palprec --paced --window --out out");
  command.callback([options] { replay(*options); });
}

}  // namespace palpable::app
