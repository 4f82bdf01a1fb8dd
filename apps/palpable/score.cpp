// palpable score: compares the output of a run, whichever program made it, with the truth.
// docs/benchmark.md has the formats of both folders and the meaning of every score.

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable/commands.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "palpable/common/body_file/body_file.h"
#include "palpable/desk/scorecard/figures.h"

#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <optional>

namespace palpable::app {
namespace {

struct ScoreOptions {
  std::filesystem::path truth;
  std::filesystem::path result;
  std::filesystem::path body;
  std::filesystem::path poses;  // empty: `truth` is the folder truth/ of a clip
  double poses_per_second = 0;  // 0: times of the file
  bool json = false;
};

// Scores only a camera's path, against published poses.
void score_path_of(const ScoreOptions& options) {
  if (!options.result.empty() || !options.body.empty()) {
    throw Error("--poses takes the place of the truth: give the result's folder or file alone");
  }
  const std::optional<double> rate =
      options.poses_per_second > 0 ? std::optional(options.poses_per_second) : std::nullopt;
  const PoseScores scores = score_poses(read_published_poses(options.poses, rate), options.truth);
  if (options.json) {
    fmt::print("{}\n", json_of(scores));
  } else {
    print_text("{}", text_of(scores));
  }
}

void score(const ScoreOptions& options) {
  if (!options.poses.empty()) return score_path_of(options);
  if (options.poses_per_second > 0) throw Error("--fps is of the poses that --poses names");
  if (options.result.empty()) throw Error("give the folder of the result, too");
  std::optional<ReducedBody> body;
  if (!options.body.empty()) body = value_or_throw(read_pressable_body(options.body));
  ProgressBar bar;
  const Scorecard scores =
      score_folders(options.truth, options.result, body ? &*body : nullptr, bar.progress());
  bar.finish();
  if (options.json) {
    fmt::print("{}\n", json_of(scores));
  } else {
    print_text("{}", text_of(scores));
  }
}

}  // namespace

void add_score(Command app) {
  auto options = std::make_shared<ScoreOptions>();
  Command command = app.add_subcommand("score", "Compare a run with the truth of what it saw");
  command
      .add_option(
          "truth", options->truth,
          "Folder of the truth: truth/ of palpable synth, or one like it. With --poses: the "
          "result's folder, or its trajectory in TUM's format")
      .required()
      .type_name("DIR|FILE");
  command
      .add_option("result", options->result,
                  "What a run left: the --out folder of palpable live, or another system's files")
      .type_name("DIR")
      .default_is("required without --poses");
  command
      .add_option("--body", options->body,
                  "Body file of the run: then it is also scored how deep the hand stays in it, "
                  "how it jumps, and its error relative to the true solution. For a body that was "
                  "touched anywhere this needs palpable live --write +meshes")
      .default_is("none: these scores are left out");
  command
      .add_option("--poses", options->poses,
                  "Poses that a data set has published of the camera, instead of a truth: a file "
                  "of TUM, KITTI (poses.txt), 7-Scenes (one of its *.pose.txt) or EuRoC "
                  "(data.csv), or the recording's folder")
      .type_name("FILE");
  command.add_option("--fps", options->poses_per_second, "Poses a second, of a file without times")
      .in_range(0.1, 1000.0)
      .default_is("KITTI's times.txt beside them or 10; 30 of 7-Scenes");
  command.add_json(options->json);
  command.footer(
      "Formats and scores: docs/benchmark.md. What a result does not hold is null (-).\n"
      "Example: palpable score clip/truth out --body bunny.palpable\n"
      "Example: palpable score --poses rgbd_dataset_freiburg1_xyz/groundtruth.txt out");
  command.callback([options] { score(*options); });
}

}  // namespace palpable::app
