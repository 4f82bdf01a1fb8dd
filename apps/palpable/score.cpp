// palpable score: what a run did against the truth of what it saw, whoever made the run.
// docs/benchmark.md has the formats of both folders and the meaning of every score.

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable/commands.h"
#include "palpable/base/error.h"
#include "palpable/base/json.h"
#include "palpable/reduced/body_file.h"
#include "palpable/scorecard/scorecard.h"

#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <optional>

namespace palpable::app {
namespace {

struct Options {
  std::filesystem::path truth;
  std::filesystem::path result;
  std::filesystem::path body;
  bool json = false;
};

void score(const Options& options) {
  std::optional<ReducedBody> body;
  if (!options.body.empty()) body = value_or_throw(read_pressable_body(options.body));
  ProgressBar bar;
  const Scorecard scores =
      score_folders(options.truth, options.result, body ? &*body : nullptr, bar.progress());
  bar.finish();
  if (options.json) {
    fmt::print("{}\n", json_of(scores));
  } else {
    fmt::print("{}", text_of(scores));
  }
}

}  // namespace

void add_score(Command app) {
  auto options = std::make_shared<Options>();
  Command command = app.add_subcommand("score", "Compare a run with the truth of what it saw");
  command
      .add_option("truth", options->truth,
                  "Folder of the truth: truth/ of palpable synth, or one like it")
      .required();
  command
      .add_option("result", options->result,
                  "What a run left: the --out folder of palpable live, or another system's files")
      .required();
  command.add_option("--body", options->body,
                     "The body of the run: then it is also scored how deep the hand stays in it, "
                     "how it jumps, and how far it is from the true answer. Of a body that was "
                     "touched anywhere that takes live --meshes");
  command.add_flag("--json", options->json, "One JSON object on stdout");
  command.footer(
      "Formats and scores: docs/benchmark.md. What a result does not hold is null (-).\n"
      "Example: palpable score clip/truth out --body bunny.palpable");
  command.callback([options] { score(*options); });
}

}  // namespace palpable::app
