// palpable bench render: CPU time of drawing alone, for scenes that were computed before.

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable/live_settings.h"
#include "palpable/common/base/cpu_time.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/common/base/this_machine.h"
#include "palpable/live/render/gl_context.h"
#include "palpable/live/sources/frame_source.h"
#include "palpable/live/view/scene_painter.h"

#include <fmt/core.h>

#include "bench/live/bench.h"
#include "bench/live/bench_clips.h"
#include "bench/live/memory_film.h"
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

constexpr int kFilm = 300;       // number of frames; the hand appears in frame 60
constexpr int kFirst = 70;       // first frame that is drawn
constexpr int kStep = 6;         // frames between two that are drawn
constexpr int kWarmUpDraws = 2;  // rounds of drawing all frames before the measurement

struct RenderBenchOptions {
  fs::path body;
  fs::path dragon;
  fs::path clips = fs::temp_directory_path() / "palpable-bench-live";
  int repeats = 5;
  bool json = false;
};

// Figures of one body: CPU time of the whole process, ms, all drawing threads together.
struct RenderFigures {
  double median = 0, p99 = 0;  // of all pictures
  int pictures = 0;
};

// The scenes of a clip in which a hand is at the body, with their results.
std::vector<DrawnFrame> processed_scenes(FrameLoop& loop, const MemoryFilm& film) {
  const std::unique_ptr<FrameSource> source = play(film, false);
  std::vector<DrawnFrame> scenes;
  Frame frame;
  for (int number = 0; number < kFilm && source->next(frame) == FrameStatus::kFrame; ++number) {
    const Scene& scene = loop.process(frame);
    if (number < kFirst || number % kStep != 0) continue;
    scenes.emplace_back();
    scenes.back().scene = scene;
  }
  return scenes;
}

RenderFigures draw_all(std::vector<DrawnFrame>& scenes, const FrameLoop& loop, int repeats) {
  ScenePainter painter({.masks = false}, loop);
  std::vector<double> ms;
  for (int pass = 0; pass < kWarmUpDraws + repeats; ++pass) {
    for (DrawnFrame& drawn : scenes) {
      const double before = process_cpu_seconds();
      painter.draw(drawn, loop.session);
      if (pass >= kWarmUpDraws) ms.push_back(1e3 * (process_cpu_seconds() - before));
    }
  }
  painter.throw_gl_errors();
  return {percentile(ms, 0.5), percentile(ms, 0.99), static_cast<int>(ms.size())};
}

RenderFigures run_body(const fs::path& body, const std::string& name,
                       const RenderBenchOptions& options, ProgressBar& bar) {
  const fs::path frames =
      kept_frames(options.clips / (name + "-press"), body, "press", kFilm, bar.progress());
  const MemoryFilm film = read_film(frames, {.frames = kFilm});
  LiveOptions live;
  live.body = body;
  live.input.source = frames.string();
  LiveSetUp setup = set_up_live(live, play(film, false));
  std::vector<DrawnFrame> scenes = processed_scenes(setup.run.loop, film);
  return draw_all(scenes, setup.run.loop, options.repeats);
}

void bench_render(RenderBenchOptions options) {
  if (options.body.empty()) {
    options.body = first_there({"build/bodies/bunny.palpable", "out/demo/bunny.palpable"});
  }
  if (options.body.empty()) throw Error("name a body file; ./demo makes one");
  if (options.dragon.empty()) options.dragon = first_there({"build/bodies/dragon.palpable"});
  const std::string renderer = value_or_throw(GlContext::offscreen()).description();
  ProgressBar bar;
  Json result;
  result["bench"] = "render";
  result["machine"] = processor_name();
  result["renderer"] = renderer;
  result["ms_dragon_720p"] = nullptr;  // stays null without a dragon
  for (const auto& [name, file] : {std::pair{std::string("bunny"), options.body},
                                   std::pair{std::string("dragon"), options.dragon}}) {
    if (file.empty()) continue;
    const RenderFigures figures = run_body(file, name, options, bar);
    result[fmt::format("ms_{}_720p", name)] = figures.median;
    result[fmt::format("ms_{}_720p_p99", name)] = figures.p99;
    if (!options.json) {
      bar.finish();
      fmt::print("{:<8}{:>8.1f} ms of CPU a picture (p99 {:.1f}), {} pictures\n", name,
                 figures.median, figures.p99, figures.pictures);
    }
  }
  bar.finish();
  if (options.json) fmt::print("{}\n", result.dump(2));
}

}  // namespace

void add_bench_render(Command bench) {
  auto options = std::make_shared<RenderBenchOptions>();
  Command command = bench.add_subcommand("render", "A picture alone: processor time at 1280 x 720");
  command.add_option("body", options->body, "Body file of the bunny")
      .default_is("build/bodies/bunny.palpable, else out/demo/bunny.palpable");
  command
      .add_option("--dragon", options->dragon,
                  "Body file of the dragon; if it is not there, it is left out")
      .default_is("build/bodies/dragon.palpable");
  command.add_option("--repeats", options->repeats, "How often each scene is drawn")
      .in_range(1, 10'000)
      .show_default();
  command.add_option("--clips", options->clips, "Where the films are kept for the next time")
      .type_name("DIR")
      .show_default();
  command.add_json(options->json);
  command.footer(
      "Scenes of the clip `press` with a hand at the body are computed once and then drawn again "
      "and again: body, light, shadows, occlusion, legend. Processor time of the whole process, "
      "because a renderer in software has threads of its own.\n"
      "Example: palpable bench render out/demo/bunny.palpable --json");
  command.callback([options] { bench_render(*options); });
}

}  // namespace palpable::app
