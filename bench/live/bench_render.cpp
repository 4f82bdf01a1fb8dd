// palpable bench render: processor time of drawing alone, of scenes that were answered before.

#include "bench/live/bench_render.h"

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable/live_setup.h"
#include "palpable/base/error.h"
#include "palpable/base/json.h"
#include "palpable/base/order_statistics.h"
#include "palpable/base/this_machine.h"
#include "palpable/clip_writer/kept_clip.h"
#include "palpable/reduced/body_file.h"
#include "palpable/render/gl_context.h"
#include "palpable/sources/frame_source.h"
#include "palpable/view/scene_painter.h"

#include <fmt/core.h>

#include "bench/live/memory_film.h"
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

constexpr int kFilm = 300;    // frames; the hand comes in the 60th
constexpr int kFirst = 70;    // frame that is drawn first
constexpr int kStep = 6;      // from one that is drawn to the next
constexpr int kWarmUp = 2;    // times that all of them are drawn before the clock starts

struct RenderBenchOptions {
  fs::path body;
  fs::path dragon;
  fs::path clips = fs::temp_directory_path() / "palpable-bench-live";
  int repeats = 5;
  bool json = false;
};

// Of one body; ms of CPU of the whole process, all drawing threads together.
struct RenderFigures {
  double median = 0, worst = 0;  // of all pictures
  int pictures = 0;
};

fs::path first_there(std::initializer_list<const char*> files) {
  std::error_code ignored;
  for (const char* file : files) {
    if (fs::exists(file, ignored)) return file;
  }
  return {};
}

// The scenes of the film in which a hand is at the body, as they were answered.
std::vector<DrawnFrame> answered_scenes(LiveSetUp& setup, FrameSource& source, ProgressBar& bar) {
  std::vector<DrawnFrame> scenes;
  FrameLoop& loop = setup.run.loop;
  Frame frame;
  for (int number = 0; number < kFilm; ++number) {
    if (source.next(frame) != FrameSource::Next::kFrame) break;
    bar.show({"answering", static_cast<double>(number), kFilm, ""});
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
  for (int pass = 0; pass < kWarmUp + repeats; ++pass) {
    for (DrawnFrame& drawn : scenes) {
      const double before = process_cpu();
      painter.draw(drawn, loop.session);
      if (pass >= kWarmUp) ms.push_back(1e3 * (process_cpu() - before));
    }
  }
  painter.throw_gl_errors();
  return {percentile(ms, 0.5), percentile(ms, 0.99), static_cast<int>(ms.size())};
}

}  // namespace
}  // namespace palpable::app
