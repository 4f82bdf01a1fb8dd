#include "apps/palpable/live_play.h"

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable/ctrl_c.h"
#include "apps/palpable/kept_picture.h"
#include "apps/palpable/live_changes.h"
#include "apps/palpable/paint_option.h"
#include "palpable/common/base/cpu_time.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/desk/clip_files/depth_image_file.h"
#include "palpable/desk/clip_files/frame_names.h"
#include "palpable/desk/clip_files/truth_camera_file.h"
#include "palpable/live/live_writer/live_output.h"
#include "palpable/live/live_writer/live_summary.h"
#include "palpable/live/player/body_in_view.h"
#include "palpable/live/player/contact_ticks.h"
#include "palpable/live/player/live_loop.h"
#include "palpable/live/player/live_text.h"
#include "palpable/live/player/run_stats.h"
#include "palpable/live/sources/wall_clock.h"
#include "palpable/live/view/figure_scores.h"
#include "palpable/live/view/painted_stress.h"
#include "palpable/live/view/scene_painter.h"
#include "palpable/live/view/scene_picture.h"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

constexpr double kPauseWait = 0.05;  // s, wait for window events while a recording is paused

// Whether pictures are needed.
[[nodiscard]] bool has_pictures(const PlayOptions& options) {
  return options.window || !options.out.empty();
}

// Returns the options if they do not contradict each other. @param other_output whether --overwrite
// also applies to another file
const PlayOptions& checked(const PlayOptions& options, bool other_output) {
  if (options.pictures && options.view != "camera") {
    throw Error("--pictures are what the camera sees: leave out --view " + options.view);
  }
  if (!options.views.empty()) {
    if (options.window) throw Error("--views: the --window shows one view, and switches it");
    if (options.pictures) throw Error("--views: --pictures are of the camera's view alone");
  }
  if (options.paused && !options.window) throw Error("--paused: a --window is paused");
  if (!options.out.empty()) return options;
  // Options about written files are an error without --out.
  for (const auto& [wanted, name] :
       {std::pair{options.pictures, "--pictures"}, std::pair{options.meshes, "--meshes"},
        std::pair{!options.frame_pictures.empty(), "--frame-pictures"},
        std::pair{options.no_masks, "--no-masks"}, std::pair{options.no_depth, "--no-depth"},
        std::pair{options.overwrite && !other_output, "--overwrite"},
        std::pair{!options.views.empty(), "--views"},
        std::pair{options.every_frame, "--every-frame"}}) {
    if (wanted) throw Error(fmt::format("{}: without --out nothing is written", name));
  }
  return options;
}

ProgressReport progress_of(const Scene& scene, int done, int total) {
  return {"live", static_cast<double>(done), static_cast<double>(total), caption_of(scene.touches)};
}

LiveView view_of(const std::string& name) {
  const auto at = std::find(kViewNames.begin(), kViewNames.end(), name);
  return static_cast<LiveView>(at - kViewNames.begin());
}

std::vector<Tile> tiles_of(const PlayOptions& options) {
  std::vector<Tile> tiles;
  for (const std::string& name : options.views) {
    const auto at = std::find(kTileNames.begin(), kTileNames.end(), name);
    tiles.push_back(static_cast<Tile>(at - kTileNames.begin()));
  }
  return tiles;
}

// The true depths that a synthetic clip has beside its pictures. @param images its folder frames/
// @throws Error if there are none
std::function<std::optional<DepthImage>(int)> true_depths(const fs::path& images) {
  const fs::path truth = (fs::absolute(images) / ".." / "truth").lexically_normal();
  std::error_code ignored;
  if (!fs::is_directory(images, ignored) || !fs::is_directory(truth / "depth", ignored)) {
    throw Error(
        fmt::format("--views truth: {} has no truth/depth beside it; films of palpable "
                    "synth have",
                    images.string()));
  }
  return [truth, unit = read_truth_camera(truth / "camera.toml").depth_unit](int frame) {
    const auto counts = read_depth_counts(truth / "depth" / frame_name(frame, ".png"));
    return counts ? std::optional(depth_of(*counts, unit)) : std::nullopt;
  };
}

SceneShow show_of(const PlayOptions& options) {
  SceneShow show;
  const NamedPaint& paint = paint_named(options.paint);
  show.field = paint.field;
  show.component = paint.component;
  show.blended = !options.opaque;
  using Occlusion = SceneShow::Occlusion;
  show.occlusion = options.occlusion == "soft"   ? Occlusion::kSoft
                   : options.occlusion == "hard" ? Occlusion::kHard
                                                 : Occlusion::kNone;
  show.contacts = show.forces = options.forces;
  return show;
}

// Warns of a body that is far too large for the view: nothing would touch it.
void warn_of_size(const LiveRun& run) {
  const Session& session = run.loop.session;
  for (int k = 0; k < session.body_count(); ++k) {
    const auto warning = larger_than_view(
        session.body(k).model().surface, session.body(k).world_from_body, run.loop.camera.camera());
    if (warning) fmt::print(stderr, "warning: {}\n", *warning);
  }
}

// The skins at rest, if meshes of every frame are to be written; else empty.
std::vector<SurfaceMesh> meshes_of(const PlayOptions& options, const Session& session) {
  std::vector<SurfaceMesh> skins;
  for (int k = 0; options.meshes && k < session.body_count(); ++k) {
    skins.push_back(session.body(k).model().surface);
  }
  return skins;
}

// The bodies' names if there are several; empty for one.
std::vector<std::string> names_of_several(const Session& session) {
  std::vector<std::string> names;
  for (int k = 0; session.body_count() > 1 && k < session.body_count(); ++k) {
    names.push_back(session.body(k).name);
  }
  return names;
}

struct Played {
  LiveCounts counts;
  RunFigures figures;
  std::unique_ptr<LiveOutput> output;  // null: no output, or no frame came
  bool user_ended = false;
  std::optional<ContactTickFigures> ticks;
};

RunMoment moment_of(const LiveCounts& counts, const LiveOutput* output) {
  return {.now = system_clock().now(),
          .cpu = process_cpu_seconds(),
          .dropped = counts.troubles.dropped,
          .left_out = output != nullptr ? output->left_out() : 0};
}

// Computes touches between frames; null if that is not wanted.
std::unique_ptr<ContactTicks> ticks_of(const PlayOptions& options, const LiveRun& run,
                                       LiveEvents& events) {
  if (options.contact_rate == 0) return nullptr;
  return std::make_unique<ContactTicks>(
      run.loop.session,
      ContactTicks::Settings{.rate = options.contact_rate,
                             .when_due = run.source->is_live() || options.paced},
      [&events](const ContactTick& tick) { events.send(tick); });
}

// Plays the run until the source or the user ends it.
// @param painter       null: nothing is drawn
// @param changes       null: the run cannot be changed
// @param begin_output  makes the output, or null; called after the first frame was processed, so
//                      that a run that cannot begin replaces no files
template <class BeginOutput>
Played play_run(const PlayOptions& options, LiveRun& run, int frames, ScenePainter* painter,
                LiveEvents& events, const StateWatch& watch, LiveChanges* changes,
                const BeginOutput& begin_output) {
  const Session& session = run.loop.session;
  ProgressBar bar;
  RunStats stats(moment_of({}, nullptr));
  LiveLoop loop(run, frames, [&](const std::string& line) { bar.say(line); });
  // Without pictures and without a known number of frames, statistics are the only
  // sign of progress.
  const bool prints_stats = options.stats || (painter == nullptr && loop.total() <= 0);
  const std::unique_ptr<ContactTicks> ticks = ticks_of(options, run, events);
  std::unique_ptr<LiveOutput> output;
  auto kept = std::make_unique<DrawnFrame>();  // reused for every frame if there is no output
  const auto user_ended = [&] {
    return asked_to_end() || (painter != nullptr && painter->ended());
  };
  // A recording stops while it is paused; frames of a camera are still processed, but not shown.
  const auto waits = [&, live = run.source->is_live()] {
    return !live && painter != nullptr && painter->holds();
  };
  while ((!loop.ended() || waits()) && !user_ended()) {
    if (changes != nullptr) changes->record(*painter, loop, events);
    if (waits()) {
      painter->handle_events(kPauseWait);
      events.serve();
      continue;
    }
    run.loop.session.keep(painter != nullptr ? painter->wants() : SceneExtras{});
    Scene* scene = loop.next_within(FrameSource::kLongestWait);
    if (prints_stats && stats.is_second_over(system_clock().now())) {
      bar.say(text_of(stats.end_stretch(moment_of(loop.counts(), output.get()))));
    }
    if (scene == nullptr) {  // picture and body stay unchanged
      if (painter != nullptr) painter->handle_events();
      events.serve();
      continue;
    }
    if (changes != nullptr) changes->apply(*painter, *scene, events);
    if (ticks) ticks->end_frame();
    events.send(*scene);
    if (ticks) ticks->begin_frame(session, *scene);
    if (watch.answered) {
      if (const auto line = watch.answered(*scene)) bar.say(*line);
    }
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
  RunFigures figures = stats.all(moment_of(counts, output.get()));
  Played played{counts, std::move(figures), std::move(output), user_ended(), {}};
  if (ticks) played.ticks = ticks->finish();
  return played;
}

LiveSummary summary(const PlayOptions& options, const LiveSetUp& setup, const Played& played,
                    const fs::path& scene, double wall) {
  const LiveRun& run = setup.run;
  LiveSummary result = summary_of(run, played.counts, played.figures, *played.output);
  result.view =
      options.views.empty() ? options.view : fmt::format("{}", fmt::join(options.views, ","));
  result.scene = scene.string();
  for (std::size_t k = 0; k < result.bodies.size(); ++k) {
    result.bodies[k].file = setup.bodies[k].file.string();
    result.bodies[k].scale = setup.bodies[k].scale;
  }
  result.wall = wall;
  return result;
}

// Locks the output folder against other runs; empty if nothing is written.
std::optional<FolderLock> lock_of(const fs::path& out) {
  if (out.empty()) return std::nullopt;
  return std::optional<FolderLock>(std::in_place, out);
}

// --frame-pictures: the frames whose pictures are written.
void read_frame_pictures(const std::vector<std::string>& words, LiveOutputSettings& settings) {
  constexpr long long kMostFrames = 100'000'000;
  for (const std::string& word : words) {
    if (word == "all") {
      settings.all_pictures = true;
      continue;
    }
    const auto number = to_whole_number(word);
    if (!number || *number < 0 || *number > kMostFrames) {
      throw Error(fmt::format(
          "--frame-pictures {}: must be numbers of frames, the first one is 0, or the word all",
          word));
    }
    settings.kept_pictures.push_back(static_cast<int>(*number));
  }
  std::sort(settings.kept_pictures.begin(), settings.kept_pictures.end());
}

LiveOutputSettings output_settings(const PlayOptions& options, const LiveRun& run) {
  const Session& session = run.loop.session;
  LiveOutputSettings settings;
  settings.folder = options.out;
  settings.starts_at = run.source->format().starts_at;
  settings.complete = options.every_frame || !run.source->is_live();
  settings.depth = !options.no_depth;
  settings.masks = !options.no_masks;
  settings.figures = options.pictures;
  read_frame_pictures(options.frame_pictures, settings);
  settings.bodies = names_of_several(session);
  settings.meshes_of = meshes_of(options, session);
  if (options.pictures) settings.touch_frames = truly_touching_frames(run.images);
  return settings;
}

std::unique_ptr<ScenePainter> painter_of(const PlayOptions& options, const LiveSetUp& setup,
                                         bool run_may_change) {
  if (!has_pictures(options)) return nullptr;
  const bool masks = !options.out.empty() && (!options.no_masks || options.pictures);
  const std::vector<Tile> tiles = tiles_of(options);
  const bool truth = std::find(tiles.begin(), tiles.end(), Tile::kTruth) != tiles.end();
  return std::make_unique<ScenePainter>(
      ScenePainterSettings{.window = options.window,
                           .view = view_of(options.view),
                           .show = show_of(options),
                           .paused = options.paused,
                           .masks = masks,
                           .run_may_change = run_may_change,
                           .tiles = tiles,
                           .true_depth = truth ? true_depths(setup.run.images) : nullptr,
                           .keep_picture =
                               [body = setup.bodies.front().file](const ColorImage& picture) {
                                 return keep_picture(body, "live", picture);
                               }},
      setup.run.loop);
}

void print_files(const PlayOptions& options, const LiveOutput& output) {
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

}  // namespace

LivePlay::LivePlay(const PlayOptions& options, const std::vector<fs::path>& inputs,
                   const fs::path& other_output)
    : options_(checked(options, !other_output.empty())),
      lock_(lock_of(options_.out)),
      earlier_(lock_ ? earlier_run(options_.out, options_.overwrite, inputs)
                     : std::vector<fs::path>()),
      events_(options_.events) {}

void LivePlay::check(const LiveSetUp& setup) const {
  const Session& session = setup.run.loop.session;
  for (int k = 0; k < session.body_count(); ++k) {
    expect_paintable(options_.paint, knows_stress(session, k), knows_contact(session, k),
                     setup.bodies[static_cast<std::size_t>(k)].file);
  }
  if (options_.contact_rate == 0) return;
  if (const auto trouble = BetweenFrames::trouble_of(session)) {
    throw Error("--contact-rate: " + trouble->message);
  }
}

bool LivePlay::play(LiveSetUp& setup, int frames, const fs::path& scene, const StateWatch& watch,
                    LiveChanges* changes) {
  LiveRun& run = setup.run;
  check(setup);
  warn_of_size(run);
  const LiveOutputSettings written = output_settings(options_, run);
  const std::unique_ptr<ScenePainter> painter = painter_of(options_, setup, changes != nullptr);

  const auto begin = std::chrono::steady_clock::now();
  listen_for_ctrl_c();
  events_.begin(run.loop.session);
  const auto begin_output = [&]() -> std::unique_ptr<LiveOutput> {
    if (!lock_) return nullptr;
    remove_earlier_run(earlier_);
    return std::make_unique<LiveOutput>(written);
  };
  const Played played =
      play_run(options_, run, frames, painter.get(), events_, watch, changes, begin_output);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  const LiveCounts& counts = played.counts;
  if (counts.processed.empty()) {
    throw Error(fmt::format("{}: no frame could be read ({} unreadable; {})", run.images.string(),
                            counts.troubles.unreadable, counts.last_trouble));
  }
  const std::optional<LiveSummary::States> states =
      watch.ended ? watch.ended() : std::optional<LiveSummary::States>();
  if (played.output) {
    played.output->finish();
    LiveSummary all = summary(options_, setup, played, scene, wall.count());
    all.states = states;
    write_live_summary(options_.out / "live.json", all);
  }
  if (painter) painter->throw_gl_errors();

  fmt::print("{}", text_of(counts, run.loop.session, wall.count()));
  if (states) fmt::print("states: {} of {} frames\n", states->hash, states->frames);
  events_.report();
  if (played.ticks) fmt::print("{}\n", text_of(*played.ticks));
  if (options_.stats) fmt::print("{}\n", text_of(played.figures));
  if (played.output) print_files(options_, *played.output);
  return played.user_ended;
}

void add_play_options(Command command, PlayOptions& options) {
  command
      .add_option(
          "--out",
          [&options](const std::vector<std::string>& words) -> std::string {
            options.out = words.front();
            return options.out.empty() ? "names no folder" : "";
          },
          "Folder to write the results into; without it nothing is written")
      .type_name("DIR")
      .words(1, 1);
  command
      .add_option(
          "--view", options.view,
          "What the pictures show. camera: what the camera sees, with the body in it; map: "
          "the room from outside as it has been seen so far, the way through it, the body; "
          "surface: what touches the body, with the other side that is assumed, and the "
          "pressed skin, from outside; depth: how far away everything is; moving: what of it "
          "moves")
      .one_of({"camera", "depth", "moving", "surface", "map"})
      .show_default();
  command
      .add_option("--views", options.views,
                  "Several of these side by side in one picture, at half their size, instead of "
                  "--view. mask: where the picture shows a body; truth: where it would with the "
                  "true depth, of a film of palpable synth, red where mask says otherwise")
      .type_name("VIEW...")
      .words(2, 7)
      .excludes("--view")
      .one_of({"camera", "depth", "moving", "surface", "map", "mask", "truth"});
  add_paint_option(command, options.paint);
  command.add_flag("--opaque", options.opaque,
                   "Paint all of a body, also where it bears next to nothing");
  command
      .add_option(
          "--occlusion", options.occlusion,
          "How what is real hides bodies behind it. soft: along outlines that depth, colour "
          "and motion decide together; hard: pixel by pixel by the measured depth alone, as "
          "the paper does; none: not at all")
      .one_of({"soft", "hard", "none"})
      .show_default();
  command.add_flag("--forces", options.forces,
                   "Draw where bodies are pressed, and an arrow with the force there");
  add_events_option(command, options.events);
  command
      .add_option("--contact-rate", options.contact_rate,
                  "Compute contact also between frames, HZ times a second, on a thread of its own: "
                  "the obstacle continues its measured motion. For haptic devices; --events sends "
                  "each result")
      .type_name("HZ")
      .in_range(30, 10'000);
  command.add_flag("--window", options.window,
                   "Show it in a window too, with a panel that switches what is shown; H lists the "
                   "keys that do the same, Escape or Q ends the run. There bodies are placed by a "
                   "click, the run begins anew, recordings begin and end, and parameters of bodies "
                   "have sliders (docs/window.md). With --view map or surface, "
                   "dragging turns it, the wheel comes nearer, R takes both back. Files get the "
                   "pictures as they are switched to, without the panel");
  command.add_flag("--paused", options.paused,
                   "With --window: stop at the first frame until the key Space or S. A recording "
                   "waits while it is paused, a camera goes on unseen");
  command.add_flag("--stats", options.stats,
                   "Say each second and at the end how fast it goes: frames a second, how old a "
                   "frame is when its picture is shown, frames dropped and left out of the files, "
                   "processor time a frame, ms by stage. live.json has it always");
  command.add_flag("--pictures", options.pictures,
                   "Also write the three pictures that best show the hand before the body, the "
                   "body before the hand, and a touch (of a clip with a truth: at least 4 mm "
                   "deep in truth)");
  command
      .add_option("--frame-pictures", options.frame_pictures,
                  "Also write the pictures of these frames, or of all, as pictures/000098.png; the "
                  "first frame is 0")
      .type_name("N ...|all");
  command.add_flag("--no-masks", options.no_masks,
                   "Leave out visible/, body_depth/ and moving/, which palpable score compares");
  command.add_flag("--no-depth", options.no_depth, "Leave out depth/, the measured depth");
  command.add_flag("--meshes", options.meshes,
                   "Also write meshes/, the body as it is drawn in each frame, with its stress: "
                   "palpable score asks for them where the body was touched anywhere");
  command.add_flag("--every-frame", options.every_frame,
                   "Of a camera or with --paced: write all frames into all files, and wait for the "
                   "disk where it is slow; otherwise film, images and meshes leave out what there "
                   "is no time for. A recording that waits for the loop is always complete");
  command.add_flag("--overwrite", options.overwrite,
                   "Replace an earlier run in --out, or an earlier file");
}

}  // namespace palpable::app
