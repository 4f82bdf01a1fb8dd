// palpable bench live: rate, CPU time and age of frames of the whole loop, for
// several configurations.

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable/live_settings.h"
#include "palpable/common/base/allocation_count.h"
#include "palpable/common/base/cpu_time.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/common/base/this_machine.h"
#include "palpable/live/live_writer/live_output.h"
#include "palpable/live/player/live_loop.h"
#include "palpable/live/player/run_stats.h"
#include "palpable/live/player/thread_shares.h"
#include "palpable/live/render/gl_context.h"
#include "palpable/live/sources/paced_source.h"
#include "palpable/live/sources/wall_clock.h"
#include "palpable/live/view/scene_painter.h"

#include <fmt/core.h>

#include "bench/live/bench.h"
#include "bench/live/bench_clips.h"
#include "bench/live/memory_film.h"
#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

constexpr int kWarmUpFrames = 30;  // first frames: memory is allocated, shaders compiled
constexpr double kRate = 30;       // 1/s, of a paced run

struct LiveBenchOptions {
  fs::path body;
  fs::path dragon;
  fs::path source;      // the user's own pictures instead of the synthetic clips; empty: the clips
  fs::path scene;       // with `source`: a scene of several bodies
  std::string contact;  // with `source`; empty: depends on the body's tables
  fs::path clips = fs::temp_directory_path() / "palpable-bench-live";
  std::vector<std::string> runs;  // empty: all
  int film = 300;                 // frames of each clip, which is played forwards and backwards
  int frames = 300;
  double seconds = 60;
  int threads = 0;  // 0: one for each processor
  bool json = false;
};

// One configuration of the loop.
struct LiveCase {
  std::string_view name;
  std::string_view film = "press";
  bool dragon = false;
  bool picture = true;
  bool files = false;
  bool paced = false;
  bool converted = false;         // pictures are converted to colours on arrival
  std::string_view contact = {};  // empty: depends on the body's tables
  int width = 0;                  // px of one eye; 0: as rendered, 1280 x 720
  int height = 0;
};

// In an order in which each clip is read only once.
constexpr std::array kCases{LiveCase{.name = "bunny"},
                            LiveCase{.name = "bare", .picture = false},
                            LiveCase{.name = "files", .files = true},
                            LiveCase{.name = "converted", .converted = true},
                            LiveCase{.name = "site", .contact = "site"},
                            LiveCase{.name = "paper", .contact = "paper"},
                            LiveCase{.name = "paced", .paced = true},
                            LiveCase{.name = "672", .width = 672, .height = 376},
                            LiveCase{.name = "1080p", .width = 1920, .height = 1080},
                            LiveCase{.name = "bunny_moving", .film = "walk-hand"},
                            LiveCase{.name = "dragon", .dragon = true}};
// The only configuration with --source.
constexpr LiveCase kSourceCase{.name = "source"};

std::string names_of_cases() {
  std::string names;
  for (const LiveCase& one : kCases)
    names += fmt::format("{}{}", names.empty() ? "" : ", ", one.name);
  return names;
}

struct LiveFigures {
  RunFigures run;
  double total_p50_ms = 0;  // sum of all stages of a frame
  double total_p99_ms = 0;
  double copy_ms = 0;  // time to copy a frame's bytes
  int allocations = 0;
  double peak_memory = 0;  // bytes, of the process up to now
};

// Measures the time to copy a frame's bytes, with ten pictures that are in no cache.
void time_copies(const MemoryFilm& film, std::vector<double>& ms) {
  std::vector<std::uint8_t> copy(film.pictures.front().size());
  for (std::size_t i = 0; i < 10; ++i) {
    const auto& picture = film.pictures[31 * i % film.pictures.size()];
    const auto begin = std::chrono::steady_clock::now();
    std::memcpy(copy.data(), picture.data(), picture.size());
    const std::chrono::duration<double, std::milli> taken =
        std::chrono::steady_clock::now() - begin;
    ms.push_back(taken.count());
  }
}

RunMoment moment_of(const LiveCounts& counts) {
  return {.now = system_clock().now(),
          .cpu = process_cpu_seconds(),
          .dropped = counts.troubles.dropped};
}

// The default files of `palpable live --out`.
std::unique_ptr<LiveOutput> output_in(const fs::path& folder) {
  if (holds_earlier_run(folder, true, {})) remove_earlier_run(folder);
  return std::make_unique<LiveOutput>(LiveOutputSettings{.folder = folder, .complete = true});
}

// The loop of `palpable live`. Counts the frames after the warm-up until the last one is drawn; its
// files may still be in progress.
class LiveCasePlayer {
 public:
  LiveCasePlayer(LiveRun& run, ScenePainter* painter, LiveOutput* output, int frames,
                 ProgressBar& bar)
      : session_(run.loop.session),
        loop_(run, frames),
        painter_(painter),
        output_(output),
        frames_(frames),
        bar_(bar) {
    totals_.reserve(static_cast<std::size_t>(std::max(frames, 0)));
  }

  LiveFigures play(std::string_view name) {
    while (done_ < kWarmUpFrames && advance(nullptr)) {}
    bar_.show({std::string(name), 0, 1, ""});
    RunStats stats(moment_of(loop_.counts()));
    LiveFigures figures;
    figures.allocations = allocations_during([&] {
      while (advance(&stats)) {}
    });
    if (totals_.empty()) throw Error(fmt::format("run {}: no frame could be read", name));
    figures.run = stats.all(moment_of(loop_.counts()));
    figures.total_p50_ms = percentile(totals_, 0.5);
    figures.total_p99_ms = percentile(totals_, 0.99);
    bar_.show({std::string(name), 1, 1, ""});
    return figures;
  }

 private:
  // Processes one frame; returns false at the end.
  bool advance(RunStats* stats) {
    Scene* scene = nullptr;
    while (scene == nullptr) {
      if (done_ == frames_ || loop_.ended()) return false;
      scene = loop_.next_within(FrameSource::kLongestWait);
    }
    std::unique_ptr<DrawnFrame> drawn = output_ != nullptr ? output_->blank() : std::move(kept_);
    std::swap(drawn->scene, *scene);
    if (painter_ != nullptr) painter_->draw(*drawn, session_);
    ++done_;
    if (stats != nullptr) {
      stats->add(drawn->scene.times, 1e3 * (system_clock().now() - loop_.taken()));
      totals_.push_back(drawn->scene.times.total_ms());
    }
    if (output_ != nullptr) {
      output_->write(std::move(drawn));
    } else {
      kept_ = std::move(drawn);
    }
    return true;
  }

  const Session& session_;
  LiveLoop loop_;
  ScenePainter* painter_;  // null: nothing is drawn
  LiveOutput* output_;     // null: no files
  int frames_;
  int done_ = 0;
  std::unique_ptr<DrawnFrame> kept_ = std::make_unique<DrawnFrame>();
  std::vector<double> totals_;  // ms
  ProgressBar& bar_;
};

// The clips of one benchmark: rendered once and kept on disk; the last one played is in memory.
class Films {
 public:
  // @param length  frames of each clip
  Films(fs::path folder, int length, ProgressBar& bar)
      : folder_(std::move(folder)), length_(length), bar_(bar) {}

  // The images' folder of a configuration.
  fs::path folder_of(const LiveCase& one, const fs::path& body) {
    const fs::path clip = folder_ / fmt::format("{}-{}", one.dragon ? "dragon" : "bunny", one.film);
    if (const auto known = frames_.find(clip.string()); known != frames_.end()) {
      return known->second;
    }
    const fs::path frames =
        kept_frames(clip, body, std::string(one.film), length_, bar_.progress());
    frames_[clip.string()] = frames;
    return frames;
  }

  const MemoryFilm& film_of(const LiveCase& one, const fs::path& frames) {
    const std::string key = fmt::format("{} {}", frames.string(), one.width);
    if (key != key_) {
      film_ = {};
      // A clip of 1080p would take 2.5 GB.
      const int count = one.height > 720 ? (length_ + 2) / 3 : length_;
      film_ = read_film(frames, {.frames = count, .width = one.width, .height = one.height});
      key_ = key;
    }
    return film_;
  }

 private:
  fs::path folder_;
  int length_;
  ProgressBar& bar_;
  std::map<std::string, fs::path> frames_;
  std::string key_;
  MemoryFilm film_;
};

// @param live  with bodies, the folder of the clip, and the contact law
LiveFigures play_case(const LiveCase& one, LiveOptions live, const MemoryFilm& film,
                      const LiveBenchOptions& options, ProgressBar& bar) {
  live.threads = options.threads;
  std::unique_ptr<FrameSource> source = play(film, one.converted);
  if (one.paced) source = paced(std::move(source));
  LiveSetUp setup = set_up_live(live, std::move(source));
  const int count =
      kWarmUpFrames + (one.paced ? static_cast<int>(kRate * options.seconds) : options.frames);
  std::unique_ptr<ScenePainter> painter;
  if (one.picture) {
    painter =
        std::make_unique<ScenePainter>(ScenePainterSettings{.masks = one.files}, setup.run.loop);
  }
  std::unique_ptr<LiveOutput> output;
  if (one.files) output = output_in(options.clips / "files");
  std::vector<double> copies;  // ms, before and after the run
  time_copies(film, copies);
  LiveFigures figures =
      LiveCasePlayer(setup.run, painter.get(), output.get(), count, bar).play(one.name);
  time_copies(film, copies);
  figures.copy_ms = percentile(copies, 0.5);
  if (output) output->finish();
  if (painter) painter->throw_gl_errors();
  figures.peak_memory = peak_memory();
  return figures;
}

LiveFigures run_case(const LiveCase& one, const LiveBenchOptions& options, const fs::path& body,
                     Films& films, ProgressBar& bar) {
  LiveOptions live;
  live.body = body;
  live.run.contact = one.contact;
  const fs::path frames = films.folder_of(one, body);
  live.input.source = frames.string();
  return play_case(one, live, films.film_of(one, frames), options, bar);
}

// Runs the loop on the user's own pictures.
LiveFigures run_source(const LiveBenchOptions& options, ProgressBar& bar) {
  LiveOptions live;
  live.body = options.body;
  live.scene = options.scene;
  live.run.contact = options.contact;
  live.input.source = options.source.string();
  const MemoryFilm film = read_film(options.source, {.frames = options.film});
  return play_case(kSourceCase, live, film, options, bar);
}

Json stages_of(const LiveFigures& figures) {
  Json stages = Json::object();
  for (const RunFigures::Stage& stage : figures.run.stages) {
    stages[stage.name] = {{"p50", stage.p50_ms}, {"p99", stage.p99_ms}};
  }
  return stages;
}

Json mode_of(const LiveFigures& figures) {
  return {{"frames", figures.run.frames},
          {"cpu_ms_per_frame", figures.run.cpu_ms_per_frame},
          {"fps", figures.run.frames_per_second},
          {"sum_of_stages_ms", {{"p50", figures.total_p50_ms}, {"p99", figures.total_p99_ms}}},
          {"copy_ms", figures.copy_ms},
          {"allocations", figures.allocations},
          {"age_frames_p99", figures.run.age_p99_ms * kRate / 1e3},
          {"dropped", figures.run.dropped},
          {"stage_ms", stages_of(figures)}};
}

using AllFigures = std::map<std::string_view, LiveFigures>;

// The keys of docs/benchmark.md; null for configurations that were not run.
void add_keys(const AllFigures& all, Json& result) {
  const auto of = [&](std::string_view name, const std::function<Json(const LiveFigures&)>& get) {
    const auto found = all.find(name);
    return found == all.end() ? Json() : get(found->second);
  };
  const auto cpu = [](const LiveFigures& f) { return Json(f.run.cpu_ms_per_frame); };
  const auto fps = [](const LiveFigures& f) { return Json(f.run.frames_per_second); };
  result["cpu_ms_per_frame"] = {{"bunny", of("bunny", cpu)},
                                {"dragon", of("dragon", cpu)},
                                {"bunny_moving", of("bunny_moving", cpu)}};
  result["fps_with_picture"] = of("bunny", fps);
  result["fps_with_files"] = of("files", fps);
  result["fps_without_picture"] = of("bare", fps);
  result["fps_672"] = of("672", fps);
  result["fps_1080p"] = of("1080p", fps);
  result["fps_dragon"] = of("dragon", fps);
  result["age_frames_p99"] =
      of("paced", [](const LiveFigures& f) { return Json(f.run.age_p99_ms * kRate / 1e3); });
  result["dropped"] = of("paced", [](const LiveFigures& f) { return Json(f.run.dropped); });
  result["hot_allocations"] = of("bunny", [](const LiveFigures& f) { return Json(f.allocations); });
  result["stage_ms"] = of("bunny", stages_of);
  result["peak_memory_mb"] =
      of("bunny", [](const LiveFigures& f) { return Json(1e-6 * f.peak_memory); });
}

// Configurations that were not run, with the reason.
using LeftOut = std::map<std::string, std::string>;

// The figures in the order of kCases.
std::vector<std::pair<std::string_view, LiveFigures>> in_order(const AllFigures& all) {
  std::vector<std::pair<std::string_view, LiveFigures>> figures;
  const auto add = [&](std::string_view name) {
    if (const auto found = all.find(name); found != all.end()) figures.push_back(*found);
  };
  add(kSourceCase.name);
  for (const LiveCase& one : kCases) add(one.name);
  return figures;
}

void print_live_table(const AllFigures& all, const LeftOut& left_out) {
  fmt::print("{:<14}{:>8}{:>10}{:>12}{:>12}{:>9}{:>9}{:>13}\n", "run", "fps", "CPU ms",
             "sum p50 ms", "sum p99 ms", "copy ms", "dropped", "allocations");
  for (const auto& [name, f] : in_order(all)) {
    fmt::print("{:<14}{:>8.1f}{:>10.1f}{:>12.1f}{:>12.1f}{:>9.2f}{:>9}{:>13}\n", name,
               f.run.frames_per_second, f.run.cpu_ms_per_frame, f.total_p50_ms, f.total_p99_ms,
               f.copy_ms, f.run.dropped, f.allocations);
  }
  for (const auto& [name, f] : in_order(all)) fmt::print("\n{}\n  {}\n", name, text_of(f.run));
  for (const auto& [name, why] : left_out) fmt::print("\n{}: left out: {}\n", name, why);
}

bool is_wanted(const LiveCase& one, const LiveBenchOptions& options) {
  if (!options.source.empty()) return false;
  const auto& runs = options.runs;
  return runs.empty() || std::find(runs.begin(), runs.end(), one.name) != runs.end();
}

void expect_consistent(const LiveBenchOptions& options) {
  if (options.source.empty()) {
    if (!options.scene.empty()) throw Error("--scene is of --source: the films have one body");
    if (!options.contact.empty())
      throw Error("--contact is of --source: of the films there are the runs site and paper");
  } else if (!options.runs.empty()) {
    throw Error("--runs are of the films; --source is one run of its own");
  }
  for (const std::string& name : options.runs) {
    if (std::none_of(kCases.begin(), kCases.end(),
                     [&](const LiveCase& c) { return c.name == name; })) {
      throw Error(fmt::format("--runs {}: not one of {}", name, names_of_cases()));
    }
  }
}

void bench_live(LiveBenchOptions options) {
  expect_consistent(options);
  if (options.body.empty() && options.scene.empty()) {
    options.body = first_there({"build/bodies/bunny.palpable", "out/demo/bunny.palpable"});
  }
  if (options.body.empty() && options.scene.empty()) {
    throw Error("name a body file; ./demo makes one");
  }
  if (options.dragon.empty()) options.dragon = first_there({"build/bodies/dragon.palpable"});
  share_drawing_threads(options.threads);
  const std::string renderer = value_or_throw(GlContext::offscreen()).description();

  ProgressBar bar;
  Films films(options.clips, options.film, bar);
  AllFigures all;
  LeftOut left_out;
  Json modes = Json::object();
  const auto add = [&](std::string_view name, LiveFigures figures) {
    modes[std::string(name)] = mode_of(figures);
    all[name] = std::move(figures);
  };
  if (!options.source.empty()) add(kSourceCase.name, run_source(options, bar));
  for (const LiveCase& one : kCases) {
    if (!is_wanted(one, options)) continue;
    const fs::path& body = one.dragon ? options.dragon : options.body;
    if (body.empty()) {
      left_out[std::string(one.name)] =
          "no body file: bake bodies/dragon.toml, or name one with --dragon";
      continue;
    }
    add(one.name, run_case(one, options, body, films, bar));
  }
  bar.finish();
  if (!options.json) return print_live_table(all, left_out);
  Json result;
  result["bench"] = "live";
  result["machine"] = processor_name();
  result["renderer"] = renderer;
  result["threads"] = options.threads > 0 ? options.threads : usual_threads();
  result["body"] = (options.scene.empty() ? options.body : options.scene).string();
  add_keys(all, result);
  result["modes"] = modes;
  result["left_out"] = left_out.empty() ? Json::object() : Json(left_out);
  fmt::print("{}\n", result.dump(2));
}

}  // namespace

void add_bench_live(Command bench) {
  auto options = std::make_shared<LiveBenchOptions>();
  Command command = bench.add_subcommand(
      "live", "The whole loop, from a camera's raw pictures to the picture and the files");
  command.add_option("body", options->body, "The bunny")
      .default_is("build/bodies/bunny.palpable, else out/demo/bunny.palpable");
  command.add_option("--dragon", options->dragon, "The dragon; without it its run is left out")
      .default_is("build/bodies/dragon.palpable");
  command.add_option("--runs", options->runs, fmt::format("Only these: {}", names_of_cases()))
      .type_name("NAME")
      .default_is("all");
  command
      .add_option("--source", options->source,
                  "Play this folder of raw stereo pairs instead, the body where its scene.toml "
                  "says: one run, called source")
      .type_name("DIR")
      .default_is("the films");
  command.add_option("--scene", options->scene, "With --source: its bodies, instead of one")
      .type_name("FILE.toml");
  command.add_option("--contact", options->contact, "With --source, as of palpable live")
      .one_of({"anywhere", "site", "paper"})
      .default_is("anywhere if the body has tables of touch, else site");
  command.add_option("--film", options->film, "Frames of each film: 3.7 MB of memory each at 720p")
      .in_range(1, 10'000)
      .show_default();
  command.add_option("--frames", options->frames, "Frames counted of each run, 30 more before")
      .in_range(1, 100'000)
      .show_default();
  command.add_option("--seconds", options->seconds, "How long the paced run plays")
      .in_range(0.1, 36000.0)
      .show_default();
  command.add_option("--clips", options->clips, "Where the films are kept for the next time")
      .type_name("DIR")
      .show_default();
  add_threads(command, options->threads, "As of palpable live: how many threads a run keeps busy");
  command.add_json(options->json);
  command.footer(
      "Pictures of a 720p stereo camera lie in memory, raw and side by side (YUYV), and play there "
      "and back as fast as the loop takes them; the run paced at 30 frames a second. Takes about "
      "three minutes, the first time as long again for the films, and 1.5 GB of memory. "
      "docs/benchmark.md says what each run is and what the keys mean.\n"
      "Example: palpable bench live out/demo/bunny.palpable --json\n"
      "Example: palpable bench live --runs bunny bare --frames 600\n"
      "Example: palpable bench live bunny.palpable --source clip/frames");
  command.callback([options] { bench_live(*options); });
}

}  // namespace palpable::app
