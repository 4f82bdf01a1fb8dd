// palpable truth CLIP --body BODY.toml

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable-bake/commands.h"
#include "apps/palpable-bake/description_argument.h"
#include "palpable/base/progress_text.h"
#include "palpable/truth/true_skins.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <thread>

namespace palpable::app {
namespace {

struct Options {
  std::string clip;
  std::string body;
  TrueSkinSettings settings;
};

void print_frame(const TrueFrame& frame) {
  const DeformedLine& line = frame.line;
  if (frame.was_there) {
    fmt::print("{:>6} {:>9.2f} {:>8.3f}  was there{}{}\n", line.frame, 1e3 * line.depth,
               line.force.norm(), line.scored ? "" : "; not scored: ", line.why);
    return;
  }
  fmt::print("{:>6} {:>9.2f} {:>8.3f} {:>9.2f} {:>10.2f} {:>9.3f} {:>8.1e}{}{}\n", line.frame,
             1e3 * line.depth, line.force.norm(), 1e3 * frame.largest_displacement,
             1e-3 * frame.largest_von_mises, 1e3 * frame.entry, frame.path_change,
             line.scored ? "" : "  not scored: ", line.why);
}

void find_truth(const Options& options) {
  const auto begin = std::chrono::steady_clock::now();
  const BodyDescription description = read_description(options.body);
  ProgressBar bar;
  const std::vector<TrueFrame> frames =
      write_true_skins(options.clip, description, options.settings, bar.progress());
  bar.finish();
  fmt::print("{:>6} {:>9} {:>8} {:>9} {:>10} {:>9} {:>8}\n", "frame", "depth/mm", "force/N",
             "moves/mm", "Mises/kPa", "entry/mm", "by way");
  for (const TrueFrame& frame : frames) print_frame(frame);
  const auto scored = std::count_if(frames.begin(), frames.end(),
                                    [](const TrueFrame& frame) { return frame.line.scored; });
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  fmt::print("{}/truth/deformed: {} frames, {} of them scored; {}\n", options.clip, frames.size(),
             scored, duration_text(taken.count()));
}

}  // namespace

void add_truth(Command app) {
  const auto options = std::make_shared<Options>();
  options->settings.threads =
      static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1U, 16U));
  Command command = app.add_subcommand(
      "truth", "The full finite-element answer to the true hand of a filmed clip");
  command.add_option("clip", options->clip, "What synth filmed: has frames/ and truth/")
      .required()
      .type_name("CLIP");
  command.add_option("--body", options->body, "The body that was filmed (docs/body.md)")
      .required()
      .type_name("BODY.toml");
  command
      .add_option("--baked", options->settings.baked,
                  "The body file that was baked from it: refuses another mesh, law or constants "
                  "than those kept beside it (NAME.snapshots, NAME.solid.h5)")
      .type_name("FILE");
  command
      .add_option("--frames", options->settings.frames,
                  "How many frames at most, spread over those that touch")
      .in_range(1, 100000)
      .show_default();
  command.add_option("--threads", options->settings.threads, "Touches that are followed at once")
      .in_range(1, 256)
      .show_default();
  command.footer(
      "Writes CLIP/truth/deformed (docs/benchmark.md). An interrupted run goes on with the\n"
      "touch in which it was.\n"
      "Example: palpable truth clip --body bodies/bunny-demo.toml --baked out/demo/bunny.palpable");
  command.callback([options] { find_truth(*options); });
}

}  // namespace palpable::app
