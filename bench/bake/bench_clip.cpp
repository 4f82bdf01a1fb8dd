// palpable-bake bench clip: response of a body's tables to the true hand of a synthetic clip.

#include "apps/common/command_line.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/common/body_file/touch_file.h"

#include "bench/bake/bench.h"
#include "bench/bake/clip_study.h"
#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

constexpr double kDeep = 0.004;  // m, as in `palpable score`; shallower touches are noise

struct BenchClipOptions {
  std::filesystem::path body;
  std::vector<std::string> clips;
  bool true_depth = false;
  bool json = false;
};

// Names of the errors of a frame, as in `palpable score`.
constexpr std::array<std::pair<const char*, double ClipFrame::*>, 4> kErrors{
    {{"displacement_error", &ClipFrame::displacement},
     {"displacement_error_mm", &ClipFrame::worst_vertex_mm},
     {"force_error", &ClipFrame::force},
     {"von_mises_error", &ClipFrame::von_mises}}};

Json frames_of(const ClipResult& compared) {
  Json frames = Json::array();
  for (const ClipFrame& frame : compared.frames) {
    Json line{{"frame", frame.frame}};
    for (const auto& [name, error] : kErrors) line[name] = frame.*error;
    frames.push_back(std::move(line));
  }
  return frames;
}

Json clip_figures(const ClipResult& compared) {
  Json figures{{"frames", compared.frames.size()}, {"frames_unseen", compared.unseen}};
  for (const auto& [name, error] : kErrors) {
    std::vector<double> values;
    for (const ClipFrame& frame : compared.frames) values.push_back(frame.*error);
    figures[name] = nullptr;
    if (values.empty()) continue;
    figures[name] = {{"median", percentile(values, 0.5)}, {"p90", percentile(values, 0.9)}};
  }
  figures["largest_jump_mm"] = compared.largest_jump_mm;
  if (!compared.milliseconds.empty()) {
    figures["ms"] = {{"median", percentile(compared.milliseconds, 0.5)},
                     {"p99", percentile(compared.milliseconds, 0.99)}};
  }
  return figures;
}

void add(ClipResult& all, const ClipResult& one) {
  all.frames.insert(all.frames.end(), one.frames.begin(), one.frames.end());
  all.milliseconds.insert(all.milliseconds.end(), one.milliseconds.begin(), one.milliseconds.end());
  all.unseen += one.unseen;
  all.largest_jump_mm = std::max(all.largest_jump_mm, one.largest_jump_mm);
}

void bench_clip(const BenchClipOptions& options) {
  const TouchableBody body = value_or_throw(read_pressable_touchable_body(options.body));
  const TrueHand hand = options.true_depth ? TrueHand::kDepth : TrueHand::kCapsules;
  ClipResult all;
  Json each = Json::object();
  for (const std::string& clip : options.clips) {
    const ClipResult compared = compare_with_true_hand(body, clip, hand, kDeep);
    each[clip] = clip_figures(compared);
    each[clip]["by_frame"] = frames_of(compared);
    add(all, compared);
  }
  Json figures = clip_figures(all);
  if (options.json) figures["clips"] = each;
  print_figures(figures, options.json);
}

}  // namespace

void add_bench_clip(Command bench) {
  const auto options = std::make_shared<BenchClipOptions>();
  Command command = bench.add_subcommand(
      "clip",
      "The response of a body's tables to the true hand of synthetic clips, against the truth");
  command
      .add_option("body", options->body, "Body file with tables of touch: the one that was filmed")
      .required()
      .type_name("FILE");
  command.add_option("clips", options->clips, "What synth filmed and palpable truth solved")
      .required()
      .type_name("DIR");
  command.add_flag("--true-depth", options->true_depth,
                   "Press with the hand's front as the clip's true depth images show it, and the "
                   "other side that live assumes, not with the whole hand");
  command.add_json(options->json);
  command.footer(
      "No camera: the hand's own capsules press in every frame, so that the errors are those of "
      "the\n"
      "tables alone. With --true-depth the error of the assumed unseen side is included (and its "
      "time\n"
      "in the ms), and frames in which no camera sees the touching part are left out. Errors of\n"
      "palpable live beyond that are the camera's. Frames at least 4 mm deep, pooled over the "
      "clips.\n"
      "Example: palpable bench clip out/demo/bunny.palpable out/demo/clip --json");
  command.callback([options] { bench_clip(*options); });
}

}  // namespace palpable::app
