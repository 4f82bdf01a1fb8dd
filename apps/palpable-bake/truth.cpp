// palpable truth CLIP --body BODY.toml, or --scene SCENE.toml

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable-bake/body_report.h"
#include "apps/palpable-bake/commands.h"
#include "apps/palpable-bake/description_argument.h"
#include "palpable/bake/truth/scene_skins.h"
#include "palpable/bake/truth/true_skins.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/progress.h"
#include "palpable/desk/clip_files/film_friction.h"
#include "palpable/desk/clip_files/scene_files.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace palpable::app {
namespace {

struct TruthOptions {
  std::string clip;
  std::string body;
  std::string scene;
  TrueSkinSettings settings;
  int threads = 0;
  bool json = false;
};

void print_frame(const TrueFrame& frame) {
  const DeformedLine& line = frame.line;
  if (frame.was_there) {
    print_text("{:>6} {:>9.2f} {:>8.3f}  was there{}{}\n", line.frame, 1e3 * line.depth,
               line.force.norm(), line.scored ? "" : "; not scored: ", line.why);
    return;
  }
  print_text("{:>6} {:>9.2f} {:>8.3f} {:>9.2f} {:>10.2f} {:>9.3f} {:>8.1e}{}{}\n", line.frame,
             1e3 * line.depth, line.force.norm(), 1e3 * frame.largest_displacement,
             1e-3 * frame.largest_von_mises, 1e3 * frame.entry, frame.path_change,
             line.scored ? "" : "  not scored: ", line.why);
}

Json json_of_line(const DeformedLine& line) {
  return {{"frame", line.frame},
          {"depth_m", line.depth},
          {"force_n", line.force.norm()},
          {"scored", line.scored},
          {"why_not_scored", line.scored ? Json() : Json(line.why)}};
}

// The coefficient with which the clip was solved.
double friction_of(const std::string& clip) { return read_film_friction(clip).value_or(0.0); }

std::string friction_text(const std::string& clip) {
  const double friction = friction_of(clip);
  return friction > 0.0 ? fmt::format("; friction {:g}", friction) : std::string();
}

// @throws Error where no frame could be solved: there is nothing to score
template <class Frame>
void refuse_all_unsolved(const std::string& clip, const std::vector<Frame>& frames) {
  const auto unsolved = [](const Frame& frame) {
    return !frame.line.scored && frame.line.why.starts_with("no solution");
  };
  if (frames.empty() || !std::all_of(frames.begin(), frames.end(), unsolved)) return;
  throw Error(fmt::format("{}: none of {} frames has a solution: frame {}: {}", clip, frames.size(),
                          frames.front().line.frame, frames.front().line.why));
}

void print_found(const TruthOptions& options, const std::vector<TrueSceneFrame>& frames,
                 double seconds) {
  if (options.json) {
    Json list = Json::array();
    for (const TrueSceneFrame& frame : frames) {
      Json entry = json_of_line(frame.line);
      entry["body"] = frame.body;
      entry["largest_displacement_m"] = frame.largest_displacement;
      entry["force_of_other_bodies_n"] = frame.between;
      list.push_back(std::move(entry));
    }
    print_json({{"folder", options.clip + "/truth/bodies"},
                {"seconds", seconds},
                {"friction", friction_of(options.clip)},
                {"solutions", std::move(list)}});
    return;
  }
  print_text("{:<12} {:>6} {:>9} {:>8} {:>9} {:>9}\n", "body", "frame", "depth/mm", "force/N",
             "moves/mm", "others/N");
  for (const TrueSceneFrame& frame : frames) {
    const DeformedLine& line = frame.line;
    print_text("{:<12} {:>6} {:>9.2f} {:>8.3f} {:>9.2f} {:>9.3f}{}{}\n", frame.body, line.frame,
               1e3 * line.depth, line.force.norm(), 1e3 * frame.largest_displacement, frame.between,
               frame.was_there ? "  was there" : "",
               line.scored ? "" : "  not scored: " + line.why);
  }
  print_text("{}/truth/bodies: {} solutions{}; {}\n", options.clip, frames.size(),
             friction_text(options.clip), duration_text(seconds));
}

void find_truth_of_scene(const TruthOptions& options) {
  if (!options.body.empty() || !options.settings.baked.empty()) {
    throw Error("--scene says which bodies there are: leave out --description and --body");
  }
  const auto begin = std::chrono::steady_clock::now();
  const std::vector<DescribedBody> described = read_scene_description(options.scene);
  const std::vector<Rigid3> poses = scene_from_bodies(described);
  std::vector<SceneSolid> solids;
  for (std::size_t k = 0; k < described.size(); ++k) {
    const DescribedBody& body = described[k];
    if (body.description.empty()) {
      throw Error(fmt::format("{}: the body '{}' has no description, from which its mesh is made",
                              options.scene, body.name));
    }
    if (!body.set.empty()) {
      throw Error(
          fmt::format("{}: the body '{}' has values of parameters, which scenes are solved "
                      "without",
                      options.scene, body.name));
    }
    solids.push_back(
        {body.name, read_description(body.description.string()), body.scale, poses[k]});
  }
  for (const SceneSolid& solid : solids) print_material_warnings(solid.description);
  ProgressBar bar;
  const std::vector<TrueSceneFrame> frames =
      write_scene_skins(options.clip, solids,
                        {.frames = options.settings.frames,
                         .threads = options.settings.threads,
                         .friction = options.settings.friction},
                        bar.progress());
  bar.finish();
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  print_found(options, frames, taken.count());
  refuse_all_unsolved(options.clip, frames);
}

void print_found(const TruthOptions& options, const std::vector<TrueFrame>& frames,
                 double seconds) {
  if (options.json) {
    Json list = Json::array();
    for (const TrueFrame& frame : frames) {
      Json entry = json_of_line(frame.line);
      if (!frame.was_there) {
        entry["largest_displacement_m"] = frame.largest_displacement;
        entry["largest_von_mises_pa"] = frame.largest_von_mises;
        entry["entry_m"] = frame.entry;
        entry["path_change"] = frame.path_change;
      }
      list.push_back(std::move(entry));
    }
    print_json({{"folder", options.clip + "/truth/deformed"},
                {"seconds", seconds},
                {"friction", friction_of(options.clip)},
                {"frames", std::move(list)}});
    return;
  }
  print_text("{:>6} {:>9} {:>8} {:>9} {:>10} {:>9} {:>8}\n", "frame", "depth/mm", "force/N",
             "moves/mm", "Mises/kPa", "entry/mm", "by way");
  for (const TrueFrame& frame : frames) print_frame(frame);
  const auto scored = std::count_if(frames.begin(), frames.end(),
                                    [](const TrueFrame& frame) { return frame.line.scored; });
  print_text("{}/truth/deformed: {} frames, {} of them scored{}; {}\n", options.clip, frames.size(),
             scored, friction_text(options.clip), duration_text(seconds));
}

void find_truth(const TruthOptions& options) {
  if (!options.scene.empty()) {
    find_truth_of_scene(options);
    return;
  }
  if (options.body.empty())
    throw Error("give --description, or --scene of a film with several bodies");
  const auto begin = std::chrono::steady_clock::now();
  const BodyDescription description = read_description(options.body);
  print_material_warnings(description);
  ProgressBar bar;
  const std::vector<TrueFrame> frames =
      write_true_skins(options.clip, description, options.settings, bar.progress());
  bar.finish();
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  print_found(options, frames, taken.count());
  refuse_all_unsolved(options.clip, frames);
}

}  // namespace

void add_truth(Command app) {
  const auto options = std::make_shared<TruthOptions>();
  Command command =
      app.add_subcommand("truth", "The full-order solution for the true hand of a synthetic clip");
  command.add_option("clip", options->clip, "What synth filmed: has frames/ and truth/")
      .required()
      .type_name("DIR");
  command.add_option("--description", options->body, "The body that was filmed (docs/body.md)")
      .type_name("FILE.toml");
  command
      .add_option("--scene", options->scene,
                  "The scene that was filmed (docs/scenes.md): its bodies are solved together, and "
                  "press each other")
      .type_name("FILE.toml");
  command.add_option("--body", options->settings.baked,
                     "The body file that was baked from it: refuses another mesh, law or constants "
                     "than those kept beside it (NAME.snapshots, NAME.solid.h5)");
  command
      .add_option("--frames", options->settings.frames,
                  "How many frames at most, spread over those that touch")
      .in_range(1, 100000)
      .show_default();
  command
      .add_option("--friction", options->settings.friction,
                  "Coulomb's coefficient between hand and body, and between the bodies of a scene")
      .in_range(0.0, 10.0)
      .default_is("what CLIP/truth/friction.txt states; without the file 0");
  add_threads(command, options->threads, "Touches that are followed at once");
  command.add_json(options->json);
  command.footer(
      "Writes CLIP/truth/deformed, of a scene CLIP/truth/bodies/NAME/deformed\n"
      "(docs/benchmark.md). An interrupted run goes on with the touch in which it was.\n"
      "Example: palpable truth out/beams --scene scenes/beams.toml --frames 10\n"
      "Example: palpable truth clip --description bodies/bunny-demo.toml --body "
      "out/demo/bunny.palpable");
  command.callback([options] {
    options->settings.threads =
        options->threads > 0
            ? options->threads
            : static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1U, 16U));
    find_truth(*options);
  });
}

}  // namespace palpable::app
