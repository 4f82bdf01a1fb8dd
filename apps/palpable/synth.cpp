// palpable synth: renders the synthetic desk to a folder of images, with the truth beside them.
//
//   DIR/frames/{left,right}/%06d.jpg   raw pairs, as a camera gives them
//   DIR/frames/calibration.yml         OpenCV stereo calibration (T in metres)
//   DIR/frames/scene.toml              the body's pose in the first rectified left camera
//   DIR/truth/                         see docs/benchmark.md

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/installed.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/nearest_word.h"
#include "palpable/common/base/output_name.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/body_file/body_file.h"
#include "palpable/common/body_file/touch_file.h"
#include "palpable/common/reduced/reduced_body.h"
#include "palpable/common/response/touchable_body.h"
#include "palpable/desk/clip_files/film_friction.h"
#include "palpable/desk/clip_files/scene_files.h"
#include "palpable/desk/clip_writer/desk_film.h"
#include "palpable/desk/clip_writer/sequence_folder.h"
#include "palpable/desk/script/beams.h"
#include "palpable/desk/script/plan_sequence.h"
#include "palpable/live/player/body_place.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

struct SynthOptions {
  std::string name;
  fs::path body;
  fs::path scene;
  int frames = 0;  // 0: the length of the sequence
  std::uint64_t seed = 1;
  std::optional<double> friction;  // none: that of the body file
  fs::path out;
  bool json = false;
};

// The sequence of a scene: palpable synth beams --scene FILE.toml.
constexpr SequenceKind kBeams{"beams", kBeamsFrames,
                              "of a scene with two beams: a finger presses the upper one until it "
                              "lies on the lower one"};

const SequenceKind& kind_of(const std::string& name) {
  if (name == kBeams.name) return kBeams;
  const auto kinds = sequence_kinds();
  const auto found = std::find_if(kinds.begin(), kinds.end(),
                                  [&](const SequenceKind& k) { return k.name == name; });
  if (found != kinds.end()) return *found;
  std::vector<std::string> names;
  for (const SequenceKind& kind : kinds) names.emplace_back(kind.name);
  names.emplace_back(kBeams.name);
  const std::string nearest = nearest_word(name, names);
  throw Error(fmt::format("no sequence is called '{}'{}; palpable synth --help lists them", name,
                          nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest)));
}

std::string list_of_kinds() {
  std::string text = "Sequences (frames):\n";
  for (const SequenceKind& kind : sequence_kinds()) {
    text += fmt::format("  {:<14}{:>5}  {}\n", kind.name, kind.frames, kind.what);
  }
  return text + fmt::format("  {:<14}{:>5}  {}\n", kBeams.name, kBeams.frames, kBeams.what);
}

// The bodies of a scene with their scales applied.
std::vector<ReducedBody> read_bodies(const fs::path& scene,
                                     const std::vector<DescribedBody>& described) {
  std::vector<ReducedBody> bodies;
  for (const DescribedBody& body : described) {
    expect_baked(body, scene);
    ReducedBody read = value_or_throw(read_pressable_body(body.file, parse_settings(body.set)));
    bodies.push_back(body.scale != 1 ? scaled(read, body.scale) : std::move(read));
  }
  return bodies;
}

// States the friction between the film's hand and its bodies, for `palpable truth` and `palpable
// live`. Nothing is stated without any.
void state_friction(const fs::path& clip, double coefficient) {
  if (coefficient > 0) write_film_friction(clip, coefficient);
}

// @return Coulomb's coefficient
double synth_scene(const SynthOptions& options, const SequenceOrder& order) {
  const std::vector<DescribedBody> described = read_scene_description(options.scene);
  const std::vector<Rigid3> poses = scene_from_bodies(described);
  const std::vector<ReducedBody> bodies = read_bodies(options.scene, described);
  std::vector<SequenceBody> filmed;
  std::vector<PlacedBody> standing;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    filmed.push_back({&bodies[k], described[k].name, poses[k]});
    standing.push_back(
        {.body = TouchableBody(bodies[k]), .world_from_body = poses[k], .name = described[k].name});
  }
  if (const auto overlap = overlap_of(standing)) {
    throw Error(fmt::format("{}: {}", options.scene.string(), *overlap));
  }
  ProgressBar bar;
  write_sequence(filmed, order, options.out, bar.progress());
  return options.friction.value_or(0.0);
}

double synth_body(const SynthOptions& options, const fs::path& file, const SequenceOrder& order) {
  const ReducedBody body = value_or_throw(read_pressable_body(file));
  ProgressBar bar;
  write_sequence(body, order, options.out, bar.progress());
  if (options.friction) return *options.friction;
  const Result<TouchableBody> with_tables = read_touchable_body(file);
  return with_tables ? friction_of(with_tables.value()) : 0.0;
}

void synth(const SynthOptions& options) {
  if (options.out.empty()) throw Error("-o: names no folder");
  require_folder_name(options.out);
  const SequenceKind& kind = kind_of(options.name);
  const int frames = options.frames > 0 ? options.frames : kind.frames;
  const bool has_scene = !options.scene.empty();
  if (options.name == kBeams.name && !has_scene) {
    throw Error("beams is of two bodies: give --scene (scenes/beams.toml is one)");
  }
  const fs::path file = has_scene              ? options.scene
                        : options.body.empty() ? default_body()
                                               : find_body(options.body);
  const SequenceOrder order{options.name, frames, options.seed, file.filename().string()};
  const double friction =
      has_scene ? synth_scene(options, order) : synth_body(options, file, order);
  state_friction(options.out, friction);
  if (options.json) {
    print_json({{"folder", options.out.string()},
                {"sequence", options.name},
                {has_scene ? "scene" : "body", file.string()},
                {"frames", frames},
                {"seed", options.seed},
                {"friction", friction}});
  } else {
    print_text("{}: {} frames of {} with {}, seed {}{}\n", options.out.string(), frames,
               options.name, file.string(), options.seed,
               friction > 0 ? fmt::format(", friction {:g}", friction) : "");
  }
}

}  // namespace

void add_synth(Command app) {
  auto options = std::make_shared<SynthOptions>();
  Command command = app.add_subcommand(
      "synth", "Film a sequence of the synthetic desk: stereo images, calibration, truth");
  command.add_option("name", options->name, "One of the sequences listed below").required();
  command.add_option("--body", options->body, "Body file: what is pressed, and where")
      .default_is(
          "build/bodies/bunny-dense.palpable, else out/demo/bunny.palpable, else the installed "
          "post");
  command
      .add_option("--scene", options->scene,
                  "Several bodies on one desk (docs/scenes.md); hands press the first of them, of "
                  "beams the upper one")
      .type_name("FILE.toml")
      .excludes("--body");
  command
      .add_option("--frames", options->frames,
                  "How many, at 30 a second; the first 60 have no hand")
      .in_range(1, 100000)
      .default_is("as listed below");
  command.add_option("--seed", options->seed, "Decides textures, noise, places, depths and motions")
      .in_range(std::uint64_t{0}, kLargestSeed)
      .show_default();
  command
      .add_option("--friction", options->friction,
                  "Coulomb's coefficient between hand and body, stated in truth/friction.txt for "
                  "truth and live; it changes no picture")
      .in_range(0.0, kMostFriction)
      .default_is("that of the body file; with --scene 0");
  command.add_option("-o,--out", options->out, "Folder to write into: frames/ and truth/")
      .type_name("DIR")
      .required();
  command.add_json(options->json);
  command.footer(list_of_kinds() +
                 "docs/benchmark.md says what each promises and what is written.\n"
                 "Example: palpable synth press --body bunny.palpable --seed 1 -o clip\n"
                 "Example: palpable synth beams --scene scenes/beams.toml -o beams");
  command.callback([options] { synth(*options); });
}

}  // namespace palpable::app
