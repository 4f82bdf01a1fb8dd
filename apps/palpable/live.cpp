// palpable live: images in, the pressed body in them out.

#include "apps/common/command_line.h"
#include "apps/common/json.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/ctrl_c.h"
#include "apps/palpable/live_output.h"
#include "apps/palpable/live_setup.h"
#include "palpable/base/error.h"
#include "palpable/base/order_statistics.h"
#include "palpable/clip_files/live_file.h"
#include "palpable/live/live_loop.h"
#include "palpable/render/gl_context.h"
#include "palpable/render/scene_renderer.h"
#include "palpable/render/window.h"
#include "palpable/view/figure_scores.h"
#include "palpable/view/map_picture.h"
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
  fs::path out;
  std::string view = "camera";
  bool window = false;
  bool pictures = false;
  bool no_masks = false;
  bool no_depth = false;
  bool overwrite = false;
};

// Draws scenes: off screen, or into the context of a window that shows them.
class Painter {
 public:
  Painter(const Options& options, const FrameLoop& loop)
      : scale_(stress_scale(loop.session.body())) {
    const PinholeCamera& camera = loop.camera.camera();
    if (options.window) {
      window_.emplace(value_or_throw(Window::open("Palpable", camera.width, camera.height)));
    } else {
      offscreen_.emplace(value_or_throw(GlContext::offscreen()));
    }
    renderer_.emplace(value_or_throw(SceneRenderer::make()));
    if (options.view == "map") {
      map_ = std::make_unique<MapPicture>(value_or_throw(MapRenderer::make()),
                                          loop.session.world_from_body());
    }
  }

  // Fills in what drawing adds to a scene, but for the scores.
  void draw(DrawnFrame& drawn, const Session& session) {
    const StageTimer timer(drawn.scene.times, "draw");
    SceneView view = view_of(drawn.scene, session.body(), scale_);
    if (map_) {  // its own caption says it
      view.legend_title.clear();
      view.caption.clear();
      view.warning.clear();
    }
    renderer_->draw(view, map_ ? inside_ : drawn.picture, &drawn.visible, &drawn.body_depth);
    if (!map_) return;
    const MappedRoom room{session.body(), session.map(), session.world_from_body(),
                          [&] { return session.keyframes(); }};
    map_->draw(drawn.scene, room, scale_, inside_, drawn.picture);
  }

  void show(const ColorImage& picture) {
    if (!window_) return;
    window_->show(picture);
    handle_events();
  }

  // Turns the map as the mouse says, and notes whether the user wants to end.
  void handle_events() {
    if (!window_) return;
    ended_ |= window_->closed();
    for (const WindowEvent& event : window_->events()) {
      ended_ |= event.kind == WindowEvent::Kind::kKey && event.key == WindowEvent::kEscape;
      if (map_) map_->handle(event);
    }
  }

  // Whether the user has closed the window or pressed Escape.
  [[nodiscard]] bool ended() const { return ended_; }

  void throw_gl_errors() const {
    const GlErrorLog& errors = window_ ? window_->gl_errors() : offscreen_->errors();
    if (errors.count() == 0) return;
    throw Error(
        fmt::format("OpenGL reported {} errors, first: {}", errors.count(), errors.first()));
  }

 private:
  std::optional<GlContext> offscreen_;
  std::optional<Window> window_;
  std::optional<SceneRenderer> renderer_;
  std::unique_ptr<MapPicture> map_;  // the room from outside, if it is to be shown
  ColorImage inside_;                // what the camera sees, where the picture is the map's
  double scale_;                     // Pa, top of the colours
  bool ended_ = false;
};

LiveSummary summary(const Options& options, const LiveRun& run, const LiveCounts& counts,
                    const LiveOutput& output, double wall) {
  const Session& session = run.loop.session;
  LiveSummary result;
  result.body = options.live.body.string();
  result.source = run.images.string();
  result.contact = options.live.contact;
  result.view = options.view;
  if (session.settings().ignore_static) {
    result.ignore_static_frames = session.settings().static_frames;
  }
  result.scale = options.live.scale;
  result.camera_from_body = session.world_from_body();  // the first frame's camera is the world
  if (const auto& color = run.source->format().color_sensor) {
    result.color_from_depth = color->color_from_depth;
  }
  if (session.settings().track) {
    const TrackerCounts tracker = session.tracker_counts();
    result.tracking = {counts.moving, counts.lost,       tracker.recognised,
                       tracker.loops, tracker.keyframes, tracker.landmarks};
  }
  if (const SurfaceMap* map = session.map()) {
    result.map = {map->blocks(), map->refused(), session.free_space()->blocked()};
  }
  result.unreadable = counts.troubles.unreadable;
  result.source_troubles = {counts.troubles.back_in_time, counts.troubles.dropped,
                            counts.troubles.stalls, counts.troubles.losses, counts.reports};
  result.frames_touching = counts.touching;
  result.first_touch_frame = counts.first_touch;
  result.deepest_press = counts.deepest;
  result.site_changes = counts.site_changes;
  result.video_codec = output.codec();
  result.pictures = output.figures();
  result.color_scale = stress_scale(session.body());
  result.wall = wall;
  for (const auto& [stage, values] : output.times()) {
    if (!values.empty()) result.median_ms.emplace_back(stage, percentile(values, 0.5));
  }
  result.processed = counts.processed;
  return result;
}

void print_counts(const LiveCounts& counts, const Session& session, double wall) {
  fmt::print("{} frames in {:.1f} s ({:.0f} ms each), {} unreadable\n", counts.processed.size(),
             wall, 1e3 * wall / static_cast<double>(counts.processed.size()),
             counts.troubles.unreadable);
  if (counts.troubles.unreadable > 0) fmt::print("last unreadable: {}\n", counts.last_trouble);
  if (!counts.lost.empty()) {
    fmt::print("the camera was lost in {} frames, first in frame {}\n", counts.lost.size(),
               counts.lost.front());
  }
  if (const SurfaceMap* room = session.map();
      room != nullptr && (room->refused() > 0 || session.free_space()->blocked() > 0)) {
    fmt::print("the map was full ({} blocks): in ground seen later what moves is told less well\n",
               room->blocks());
  }
  if (counts.first_touch) {
    fmt::print("touched in {} frames, first in frame {}, at most {:.1f} mm deep\n", counts.touching,
               *counts.first_touch, counts.deepest * 1e3);
  } else {
    fmt::print("never touched\n");
  }
}

ProgressReport progress_of(const Scene& scene, int done, int total) {
  return {"live", static_cast<double>(done), static_cast<double>(total),
          scene.touches.empty() ? std::string("not touched")
                                : fmt::format("site {}, {:.1f} mm", scene.touches.front().site,
                                              scene.touches.front().press_depth * 1e3)};
}

// Plays the run to its end, or to the user's.
// @param begin_output  makes the output; called when the first frame was answered, so that nothing
//                      is replaced by a run that cannot begin
// @return what happened, and the output; null when no frame could be used
template <class BeginOutput>
std::pair<LiveCounts, std::unique_ptr<LiveOutput>> play(const Options& options, LiveRun& run,
                                                        Painter& painter,
                                                        const BeginOutput& begin_output) {
  const Session& session = run.loop.session;
  ProgressBar bar;
  LiveLoop loop(run, options.live.frames, [&](const std::string& line) {
    bar.finish();
    fmt::print(stderr, "{}\n", line);
  });
  std::unique_ptr<LiveOutput> output;
  while (!loop.ended() && !painter.ended() && !asked_to_end()) {
    Scene* scene = loop.next_within(FrameSource::kLongestWait);
    if (scene == nullptr) {  // the picture and the body stay as they are
      painter.handle_events();
      continue;
    }
    if (!output) output = begin_output();
    std::unique_ptr<DrawnFrame> drawn = output->blank();
    std::swap(drawn->scene, *scene);
    painter.draw(*drawn, session);
    if (options.pictures) {
      drawn->scores = figure_scores(drawn->scene, session.body(), drawn->visible, drawn->body_depth,
                                    session.pressing_depth());
    }
    painter.show(drawn->picture);
    const int done = static_cast<int>(loop.counts().processed.size());
    const int total = painter.ended() ? done : loop.total();
    const ProgressReport progress = progress_of(drawn->scene, done, total);
    output->write(std::move(drawn));
    if (total > 0) bar.show(progress);
  }
  return {loop.counts(), std::move(output)};
}

void live(const Options& options) {
  LiveOptions wanted = options.live;
  if (options.pictures && options.view != "camera") {
    throw Error("--pictures are what the camera sees: leave out --view map");
  }
  if (options.out.empty()) throw Error("--out: names no folder");
  const SourceOptions& input = wanted.input;
  const std::vector<fs::path> earlier =
      earlier_run(options.out, options.overwrite,
                  {wanted.body, input.source, input.right, input.depth, input.calibration});
  wanted.clip = options.out / "clip";
  LiveRun run = set_up_live(wanted);
  Painter painter(options, run.loop);

  const auto begin = std::chrono::steady_clock::now();
  listen_for_ctrl_c();
  const auto [counts, output] = play(options, run, painter, [&] {
    remove_earlier_run(earlier);
    return std::make_unique<LiveOutput>(LiveOutputSettings{.folder = options.out,
                                                           .depth = !options.no_depth,
                                                           .masks = !options.no_masks,
                                                           .figures = options.pictures});
  });
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  if (!output) {
    throw Error(fmt::format("{}: no frame could be read ({} unreadable; {})", run.images.string(),
                            counts.troubles.unreadable, counts.last_trouble));
  }
  output->finish();
  write_live_summary(options.out / "live.json",
                     summary(options, run, counts, *output, wall.count()));
  painter.throw_gl_errors();

  print_counts(counts, run.loop.session, wall.count());
  fmt::print("{}\n", (options.out / "touch.mp4").string());
  for (const std::string& name : output->figures()) {
    fmt::print("{}\n", (options.out / name).string());
  }
}

}  // namespace

void add_live(Command app) {
  auto options = std::make_shared<Options>();
  Command command =
      app.add_subcommand("live", "Let what a camera saw press a body: video, figures, timing");
  add_live_options(command, options->live);
  command.add_option("--out", options->out, "Folder for the results").required();
  command
      .add_option("--view", options->view,
                  "What the pictures show. camera: what the camera sees, with the body in it; map: "
                  "the room from outside as it has been seen so far, the way through it, the body")
      .one_of({"camera", "map"})
      .show_default();
  command.add_flag("--window", options->window,
                   "Show it in a window too; Escape ends it. The mouse turns the map, its wheel "
                   "comes nearer, R takes both back");
  command.add_flag("--pictures", options->pictures,
                   "Keep the pictures that show best: hand nearer, body nearer, touch");
  command.add_flag("--no-masks", options->no_masks,
                   "Leave out visible/, body_depth/ and moving/, which palpable score compares");
  command.add_flag("--no-depth", options->no_depth, "Leave out depth/, the measured depth");
  command.add_flag("--overwrite", options->overwrite, "Replace an earlier run in --out");
  command.footer(
      "Writes touch.mp4, timing.csv, touches.jsonl, trajectory.txt, pose.jsonl, "
      "rectification.jsonl,\n"
      "live.json, depth/, visible/, body_depth/ and moving/ (docs/benchmark.md has the formats).\n"
      "A recording waits for the loop unless --paced. A camera that stalls or goes away does not "
      "end\n"
      "the run: the last state is held until pictures come again; Ctrl-C ends it.\n"
      "Example: palpable live bunny.palpable --source synthetic --out out\n"
      "Example: palpable live bunny.palpable --source desk --place \"0 0.1 0.6 0 40 0\" "
      "--ignore-static --out out\n"
      "Example: palpable live bunny.palpable --source /dev/video0 --calibration SN10027514.conf "
      "--place \"0 0.1 0.6 0 40 0\" --window --out out");
  command.callback([options] { live(*options); });
}

}  // namespace palpable::app
