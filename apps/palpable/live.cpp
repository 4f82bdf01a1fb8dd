// palpable live: images in, the pressed body in them out.

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/ctrl_c.h"
#include "apps/palpable/live_events.h"
#include "apps/palpable/live_setup.h"
#include "palpable/base/error.h"
#include "palpable/base/folder_lock.h"
#include "palpable/base/this_machine.h"
#include "palpable/live/body_in_view.h"
#include "palpable/live/live_loop.h"
#include "palpable/live/live_text.h"
#include "palpable/live/run_stats.h"
#include "palpable/live_writer/live_output.h"
#include "palpable/live_writer/live_summary.h"
#include "palpable/sources/wall_clock.h"
#include "palpable/view/figure_scores.h"
#include "palpable/view/scene_painter.h"
#include "palpable/view/scene_picture.h"

#include <fmt/core.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

struct Options {
  LiveOptions live;
  fs::path out;  // empty: nothing is written
  std::string events = kNoEvents;
  std::string view = "camera";
  bool window = false;
  bool pictures = false;
  bool no_masks = false;
  bool no_depth = false;
  bool meshes = false;
  bool overwrite = false;
  bool every_frame = false;
  bool stats = false;
};

// Whether anybody looks at pictures.
[[nodiscard]] bool has_pictures(const Options& options) {
  return options.window || !options.out.empty();
}

// What says how files are written says nothing where none are.
void expect_out_where_files_are_wanted(const Options& options) {
  if (!options.out.empty()) return;
  for (const auto& [wanted, name] :
       {std::pair{options.pictures, "--pictures"}, std::pair{options.meshes, "--meshes"},
        std::pair{options.no_masks, "--no-masks"}, std::pair{options.no_depth, "--no-depth"},
        std::pair{options.overwrite, "--overwrite"},
        std::pair{options.every_frame, "--every-frame"}}) {
    if (wanted) throw Error(fmt::format("{}: without --out nothing is written", name));
  }
}

ProgressReport progress_of(const Scene& scene, int done, int total) {
  return {"live", static_cast<double>(done), static_cast<double>(total), caption_of(scene.touches)};
}

ScenePainterSettings::View view_of(const std::string& name) {
  using View = ScenePainterSettings::View;
  return name == "map" ? View::kMap : name == "surface" ? View::kSurface : View::kCamera;
}

// A run on a house around the desk goes well and touches nothing.
void warn_of_size(const LiveRun& run) {
  const Session& session = run.loop.session;
  for (int k = 0; k < session.body_count(); ++k) {
    const auto warning = larger_than_view(session.body(k).surface, session.world_from_body(k),
                                          run.loop.camera.camera());
    if (warning) fmt::print(stderr, "warning: {}\n", *warning);
  }
}

// The skins of which every frame's are to be written.
std::vector<SurfaceMesh> meshes_of(const Options& options, const Session& session) {
  std::vector<SurfaceMesh> skins;
  for (int k = 0; options.meshes && k < session.body_count(); ++k) {
    skins.push_back(session.body(k).surface);
  }
  return skins;
}

// Of several bodies their names.
std::vector<std::string> names_of_several(const Session& session) {
  std::vector<std::string> names;
  for (int k = 0; session.body_count() > 1 && k < session.body_count(); ++k) {
    names.push_back(session.body_name(k));
  }
  return names;
}

struct Played {
  LiveCounts counts;
  RunFigures figures;
  std::unique_ptr<LiveOutput> output;  // null: nothing is written, or no frame came
};

RunMoment moment_of(const LiveCounts& counts, const LiveOutput* output) {
  return {.now = system_clock().now(),
          .cpu = process_cpu(),
          .dropped = counts.troubles.dropped,
          .left_out = output != nullptr ? output->left_out() : 0};
}

// Plays the run to its end, or to the user's.
// @param painter       null: nobody looks, nothing is drawn
// @param begin_output  makes the output, or null; called when the first frame was answered, so that
//                      nothing is replaced by a run that cannot begin
template <class BeginOutput>
Played play(const Options& options, LiveRun& run, ScenePainter* painter, LiveEvents& events,
            const BeginOutput& begin_output) {
  const Session& session = run.loop.session;
  ProgressBar bar;
  RunStats stats(moment_of({}, nullptr));
  LiveLoop loop(run, options.live.frames, [&](const std::string& line) { bar.say(line); });
  // Who neither sees pictures nor how far a recording is would see nothing at all.
  const bool tells_stats = options.stats || (painter == nullptr && loop.total() <= 0);
  std::unique_ptr<LiveOutput> output;
  auto kept = std::make_unique<DrawnFrame>();  // where there is no output: drawn again and again
  const auto user_ended = [&] {
    return asked_to_end() || (painter != nullptr && painter->ended());
  };
  while (!loop.ended() && !user_ended()) {
    Scene* scene = loop.next_within(FrameSource::kLongestWait);
    if (tells_stats && stats.is_second_over(system_clock().now())) {
      bar.say(text_of(stats.end_stretch(moment_of(loop.counts(), output.get()))));
    }
    if (scene == nullptr) {  // the picture and the body stay as they are
      if (painter != nullptr) painter->handle_events();
      events.serve();
      continue;
    }
    events.tell(*scene);
    if (!output) output = begin_output();
    std::unique_ptr<DrawnFrame> drawn = output ? output->blank() : std::move(kept);
    std::swap(drawn->scene, *scene);
    if (painter != nullptr) {
      painter->draw(*drawn, session);
      painter->show(drawn->picture);
    }
    stats.add(drawn->scene.times, 1e3 * (system_clock().now() - loop.taken()));
    if (options.pictures && drawn->in_files) {
      drawn->scores = figure_scores(drawn->scene, session, drawn->visible, drawn->body_depth);
    }
    const int done = static_cast<int>(loop.counts().processed.size());
    const int total = user_ended() ? done : loop.total();
    if (total > 0) bar.show(progress_of(drawn->scene, done, total));
    if (output) {
      output->write(std::move(drawn));
    } else {
      kept = std::move(drawn);
    }
  }
  const LiveCounts& counts = loop.counts();
  return {counts, stats.all(moment_of(counts, output.get())), std::move(output)};
}

LiveSummary summary(const Options& options, const LiveSetUp& setup, const Played& played,
                    double wall) {
  const LiveRun& run = setup.run;
  LiveSummary result = summary_of(run, played.counts, played.figures, *played.output);
  result.view = options.view;
  result.scene = options.live.scene.string();
  for (std::size_t k = 0; k < result.bodies.size(); ++k) {
    result.bodies[k].file = setup.files[k].string();
    result.bodies[k].scale = setup.scales[k];
  }
  result.wall = wall;
  return result;
}

// Folder of a run, so that no other one writes there; nothing where nothing is written.
std::optional<FolderLock> lock_of(const fs::path& out) {
  if (out.empty()) return std::nullopt;
  return std::optional<FolderLock>(std::in_place, out);
}

LiveOutputSettings output_settings(const Options& options, const LiveRun& run) {
  const Session& session = run.loop.session;
  LiveOutputSettings settings;
  settings.folder = options.out;
  settings.complete = options.every_frame || !run.source->is_live();
  settings.depth = !options.no_depth;
  settings.masks = !options.no_masks;
  settings.figures = options.pictures;
  settings.bodies = names_of_several(session);
  settings.meshes_of = meshes_of(options, session);
  if (options.pictures) settings.touch_frames = truly_touching_frames(run.images);
  return settings;
}

std::unique_ptr<ScenePainter> painter_of(const Options& options, const LiveRun& run) {
  if (!has_pictures(options)) return nullptr;
  const bool masks = !options.out.empty() && (!options.no_masks || options.pictures);
  return std::make_unique<ScenePainter>(
      ScenePainterSettings{.window = options.window, .view = view_of(options.view), .masks = masks},
      run.loop);
}

void print_files(const Options& options, const LiveOutput& output) {
  if (output.left_out() > 0) {
    fmt::print(
        "{} of these frames are in the texts only, {} not even there: the disk was behind; "
        "--every-frame waits for it\n",
        output.left_out(), output.lines_left_out());
  }
  fmt::print("{}\n", (options.out / "touch.mp4").string());
  for (const std::string& name : output.figures()) {
    fmt::print("{}\n", (options.out / name).string());
  }
}

void live(const Options& options) {
  LiveOptions wanted = options.live;
  if (options.pictures && options.view != "camera") {
    throw Error("--pictures are what the camera sees: leave out --view " + options.view);
  }
  expect_out_where_files_are_wanted(options);
  const std::optional<FolderLock> lock = lock_of(options.out);
  std::vector<fs::path> earlier;
  if (lock) {
    earlier = earlier_run(options.out, options.overwrite, inputs_of(wanted));
    wanted.clip = options.out / "clip";
  }
  share_threads(wanted.threads);
  LiveEvents events(options.events);
  LiveSetUp setup = set_up_live(wanted);
  LiveRun& run = setup.run;
  warn_of_size(run);
  const LiveOutputSettings written = output_settings(options, run);
  const std::unique_ptr<ScenePainter> painter = painter_of(options, run);

  const auto begin = std::chrono::steady_clock::now();
  listen_for_ctrl_c();
  events.begin(run.loop.session);
  const auto begin_output = [&]() -> std::unique_ptr<LiveOutput> {
    if (!lock) return nullptr;
    remove_earlier_run(earlier);
    return std::make_unique<LiveOutput>(written);
  };
  const Played played = play(options, run, painter.get(), events, begin_output);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  const LiveCounts& counts = played.counts;
  if (counts.processed.empty()) {
    throw Error(fmt::format("{}: no frame could be read ({} unreadable; {})", run.images.string(),
                            counts.troubles.unreadable, counts.last_trouble));
  }
  if (played.output) {
    played.output->finish();
    write_live_summary(options.out / "live.json", summary(options, setup, played, wall.count()));
  }
  if (painter) painter->throw_gl_errors();

  fmt::print("{}", text_of(counts, run.loop.session, wall.count()));
  events.report();
  if (options.stats) fmt::print("{}\n", text_of(played.figures));
  if (played.output) print_files(options, *played.output);
}

}  // namespace

void add_live(Command app) {
  auto options = std::make_shared<Options>();
  Command command =
      app.add_subcommand("live", "Let what a camera saw press bodies: video, figures, timing");
  add_live_options(command, options->live);
  command
      .add_option(
          "--out",
          [options](const std::vector<std::string>& words) -> std::string {
            options->out = words.front();
            return options->out.empty() ? "names no folder" : "";
          },
          "Folder to write the results into; without it nothing is written")
      .type_name("DIR")
      .words(1, 1);
  command
      .add_option("--view", options->view,
                  "What the pictures show. camera: what the camera sees, with the body in it; map: "
                  "the room from outside as it has been seen so far, the way through it, the body; "
                  "surface: what touches the body, with the other side that is assumed, and the "
                  "pressed skin, from outside")
      .one_of({"camera", "map", "surface"})
      .show_default();
  add_events_option(command, options->events);
  command.add_flag("--window", options->window,
                   "Show it in a window too; Escape or Q ends the run. With --view map or surface, "
                   "dragging turns it, the wheel comes nearer, R takes both back");
  command.add_flag("--stats", options->stats,
                   "Say each second and at the end how fast it goes: frames a second, how old a "
                   "frame is when its picture is shown, frames dropped and left out of the files, "
                   "processor time a frame, ms by stage. live.json has it always");
  command.add_flag("--pictures", options->pictures,
                   "Also write the three pictures that best show the hand before the body, the "
                   "body before the hand, and a touch (of a clip with a truth: at least 4 mm "
                   "deep in truth)");
  command.add_flag("--no-masks", options->no_masks,
                   "Leave out visible/, body_depth/ and moving/, which palpable score compares");
  command.add_flag("--no-depth", options->no_depth, "Leave out depth/, the measured depth");
  command.add_flag("--meshes", options->meshes,
                   "Also write meshes/, the body as it is drawn in each frame, with its stress: "
                   "palpable score asks for them where the body was touched anywhere");
  command.add_flag("--every-frame", options->every_frame,
                   "Of a camera or with --paced: write all frames into all files, and wait for the "
                   "disk where it is slow; otherwise film, images and meshes leave out what there "
                   "is no time for. A recording that waits for the loop is always complete");
  command.add_flag("--overwrite", options->overwrite, "Replace an earlier run in --out");
  command.footer(
      "With --out it writes touch.mp4, timing.csv, touches.jsonl, trajectory.txt, pose.jsonl, "
      "rectification.jsonl, live.json, depth/, visible/, body_depth/ and moving/ "
      "(docs/benchmark.md has the formats).\n"
      "A recording waits for the loop unless --paced. A camera that stalls or goes away does not "
      "end the run: the last state is held until pictures come again; Ctrl-C ends it.\n"
      "Example: palpable live bunny.palpable --source synthetic --out out\n"
      "Example: palpable live --scene scenes/beams.toml --source clip/frames --out out\n"
      "Example: palpable live bunny.palpable --source desk --place \"0 0.1 0.6 0 40 0\" "
      "--out out\n"
      "Example: palpable live bunny.palpable --source /dev/video0 --calibration SN10027514.conf "
      "--place \"0 0.1 0.6 0 40 0\" --window\n"
      "Example: palpable live bunny.palpable --source /dev/video0 --anchor plane --window --out "
      "out");
  command.callback([options] { live(*options); });
}

}  // namespace palpable::app
