// palpable synth: the synthetic desk as a folder of images, and its truth beside them.
//
//   DIR/frames/{left,right}/%06d.jpg   raw pairs, as a camera gives them
//   DIR/frames/calibration.yml         OpenCV stereo calibration (T in metres)
//   DIR/frames/scene.toml              where the body stands, in the rectified left camera
//   DIR/truth/hand.jsonl               capsules per frame, rectified left camera, m
//   DIR/truth/contact.jsonl            the hand against the undeformed body
//   DIR/truth/depth/%06d.png           16 bit, 0.1 mm, 0 none; rectified left camera at half size
//   DIR/truth/camera.toml, script.toml that camera; what happens when

#include "apps/common/progress_bar.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/press_clip_folder.h"
#include "palpable/base/error.h"
#include "palpable/reduced/body_file.h"

#include <CLI/CLI.hpp>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

namespace palpable::app {
namespace {

struct SynthOptions {
  std::string clip;
  std::filesystem::path body;
  int frames = 300;
  std::uint64_t seed = 1;
  std::filesystem::path out;
};

}  // namespace

void add_synth(CLI::App& app) {
  auto options = std::make_shared<SynthOptions>();
  CLI::App* command = app.add_subcommand(
      "synth", "Write a clip of the synthetic desk: stereo images, calibration, truth");
  command->add_option("clip", options->clip, "What happens: press (a finger presses the body)")
      ->required()
      ->check(CLI::IsMember({"press"}));
  command->add_option("--body", options->body, "Body file: what is pressed, and where")->required();
  command->add_option("--frames", options->frames, "Length at 30 fps; the first 60 have no hand")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Textures, noise, sites, depths")
      ->capture_default_str();
  command->add_option("-o,--out", options->out, "Folder for frames/ and truth/")->required();
  command->footer(
      "Example: palpable synth press --body bunny.palpable --frames 300 --seed 1 -o clip");
  command->callback([options] {
    const ReducedBody body = value_or_throw(read_body_file(options->body));
    ProgressBar bar;
    write_press_clip(body, options->frames, options->seed, options->out, bar.progress());
  });
}

}  // namespace palpable::app
