// palpable score: compares the output of a run, whichever program made it, with the truth.
// docs/benchmark_files.md has the formats of both folders and the meaning of every score.

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable/commands.h"
#include "palpable/common/base/error.h"
#include "palpable/common/body_file/body_file.h"
#include "palpable/desk/scorecard/figures.h"

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

template <class Scores>
void print_scores(const Scores& scores, bool json) {
  if (json) {
    print_json(json_of(scores));
  } else {
    print_text("{}", text_of(scores));
  }
}

// Scores only a camera's path, against published poses.
void score_path_of(const ScoreOptions& options) {
  if (!options.result.empty() || !options.body.empty()) {
    throw Error("--poses takes the place of the truth: give the result's folder or file alone");
  }
  const std::optional<double> rate =
      options.poses_per_second > 0 ? std::optional(options.poses_per_second) : std::nullopt;
  print_scores(score_poses(read_published_poses(options.poses, rate), options.truth), options.json);
}

void score(const ScoreOptions& options) {
  if (!options.poses.empty()) return score_path_of(options);
  if (options.poses_per_second > 0) {
    throw Error("--fps is the rate of published poses: give their file with --poses");
  }
  if (options.result.empty()) {
    throw Error("the folder of the result is missing: palpable score TRUTH RESULT");
  }
  std::optional<ReducedBody> body;
  if (!options.body.empty()) body = value_or_throw(read_pressable_body(options.body));
  ProgressBar bar;
  const Scorecard scores =
      score_folders(options.truth, options.result, body ? &*body : nullptr, bar.progress());
  bar.finish();
  print_scores(scores, options.json);
}

}  // namespace

void add_score(Command app) {
  auto options = std::make_shared<ScoreOptions>();
  Command command = app.add_subcommand("score", "Compare a run with the truth of what it saw");
  command
      .add_option("truth", options->truth,
                  "Folder with the truth: truth/ of a clip that palpable synth filmed, or one laid "
                  "out like it. With --poses: the result's folder, or its trajectory as a file")
      .type_name("DIR")
      .required();
  command
      .add_option("result", options->result,
                  "Folder with what a run left: the --out folder of palpable live, or files of "
                  "another system")
      .type_name("DIR")
      .default_is("none, required without --poses");
  command
      .add_option("--body", options->body,
                  "Body file of the run. With it the error relative to the true solution, and how "
                  "deep the hand stays in the surface and how that jumps, are also scored where "
                  "the run left no meshes but sites and levels")
      .type_name("FILE");
  command.add_json(options->json);
  command.begin_group("Camera's path alone");
  command
      .add_option("--poses", options->poses,
                  "Poses of the camera that a data set has published, instead of a truth: a file "
                  "of TUM, KITTI (poses.txt), 7-Scenes (one of its *.pose.txt) or EuRoC "
                  "(data.csv), or the recording's folder")
      .type_name("FILE");
  command
      .add_option("--fps", options->poses_per_second,
                  "Rate of published poses whose file has no times, poses per second")
      .in_range(0.1, 1000.0)
      .default_is("KITTI's times.txt beside them, else 10; 30 for 7-Scenes");
  command.footer(
      "The first three lines say what was compared, how good the result is and how fast it was. "
      "Figures with a target of this project have a verdict beside them. What truth or result "
      "lack is shown as - (null with --json). Formats and scores: docs/benchmark.md.\n"
      "Example: palpable score clip/truth out --body bunny.palpable\n"
      "         palpable score --poses rgbd_dataset_freiburg1_xyz/groundtruth.txt out");
  command.callback([options] { score(*options); });
}

}  // namespace palpable::app
