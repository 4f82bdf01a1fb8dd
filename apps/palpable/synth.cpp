// palpable synth: the synthetic desk as a folder of images, and its truth beside them.
//
//   DIR/frames/{left,right}/%06d.jpg   raw pairs, as a camera gives them
//   DIR/frames/calibration.yml         OpenCV stereo calibration (T in metres)
//   DIR/frames/scene.toml              where the body stands, in the first rectified left camera
//   DIR/truth/                         what docs/benchmark.md lists

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/default_body.h"
#include "palpable/base/error.h"
#include "palpable/base/nearest_word.h"
#include "palpable/clip_writer/desk_film.h"
#include "palpable/clip_writer/sequence_folder.h"
#include "palpable/reduced/body_file.h"
#include "palpable/script/plan_sequence.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

struct SynthOptions {
  std::string name;
  fs::path body;
  int frames = 0;  // 0: the sequence's own
  std::uint64_t seed = 1;
  fs::path out;
};

const SequenceKind& kind_of(const std::string& name) {
  const auto kinds = sequence_kinds();
  const auto found = std::find_if(kinds.begin(), kinds.end(),
                                  [&](const SequenceKind& k) { return k.name == name; });
  if (found != kinds.end()) return *found;
  std::vector<std::string> names;
  for (const SequenceKind& kind : kinds) names.emplace_back(kind.name);
  const std::string nearest = nearest_word(name, names);
  throw Error(fmt::format("no sequence is called '{}'{}; palpable synth --help lists them", name,
                          nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest)));
}

std::string list_of_kinds() {
  std::string text = "Sequences (frames):\n";
  for (const SequenceKind& kind : sequence_kinds()) {
    text += fmt::format("  {:<14}{:>5}  {}\n", kind.name, kind.frames, kind.what);
  }
  return text;
}

void synth(const SynthOptions& options) {
  if (options.out.empty()) throw Error("-o: names no folder");
  const SequenceKind& kind = kind_of(options.name);
  const fs::path file = options.body.empty() ? default_body() : options.body;
  const ReducedBody body = value_or_throw(read_pressable_body(file));
  ProgressBar bar;
  write_sequence(body,
                 {options.name, options.frames > 0 ? options.frames : kind.frames, options.seed,
                  file.filename().string()},
                 options.out, bar.progress());
}

}  // namespace

void add_synth(Command app) {
  auto options = std::make_shared<SynthOptions>();
  Command command = app.add_subcommand(
      "synth", "Film a sequence of the synthetic desk: stereo images, calibration, truth");
  command.add_option("name", options->name, "One of the sequences listed below").required();
  command.add_option("--body", options->body,
                     "Body file: what is pressed, and where. Default: "
                     "build/bodies/bunny-dense.palpable, else out/demo/bunny.palpable");
  command
      .add_option("--frames", options->frames,
                  "How many, at 30 a second; the first 60 have no hand. Default: as listed below")
      .in_range(1, 100000);
  command.add_option("--seed", options->seed, "Decides textures, noise, places, depths and motions")
      .in_range(std::uint64_t{0}, kLargestSeed)
      .show_default();
  command.add_option("-o,--out", options->out, "Folder to write frames/ and truth/ into")
      .required();
  command.footer(list_of_kinds() +
                 "docs/benchmark.md says what each promises and what is written.\n"
                 "Example: palpable synth press --body bunny.palpable --seed 1 -o clip");
  command.callback([options] { synth(*options); });
}

}  // namespace palpable::app
