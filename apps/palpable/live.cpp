// palpable live: images in, the pressed body in them out.

#include "apps/common/command_line.h"
#include "apps/common/json.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/ctrl_c.h"
#include "apps/palpable/live_output.h"
#include "apps/palpable/live_setup.h"
#include "apps/palpable/vision_thread.h"
#include "palpable/base/error.h"
#include "palpable/base/order_statistics.h"
#include "palpable/clip_files/live_file.h"
#include "palpable/render/gl_context.h"
#include "palpable/render/scene_renderer.h"
#include "palpable/render/window.h"
#include "palpable/view/figure_scores.h"
#include "palpable/view/map_picture.h"
#include "palpable/view/scene_picture.h"

#include <fmt/core.h>

#include <algorithm>
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

// Where pictures are drawn: off screen, or into the context of a window that shows them.
struct Stage {
  std::optional<GlContext> offscreen;
  std::optional<Window> window;

  [[nodiscard]] const GlErrorLog& errors() const {
    return window ? window->gl_errors() : offscreen->errors();
  }
};

Stage make_stage(bool with_window, const PinholeCamera& camera) {
  Stage stage;
  if (with_window) {
    stage.window = value_or_throw(Window::open("Palpable", camera.width, camera.height));
  } else {
    stage.offscreen = value_or_throw(GlContext::offscreen());
  }
  return stage;
}

// Whether the user has closed the window or pressed Escape; the map, if one is shown, is turned.
bool ended_by(Window& window, MapPicture* map) {
  bool ended = window.closed();
  for (const WindowEvent& event : window.events()) {
    ended |= event.kind == WindowEvent::Kind::kKey && event.key == WindowEvent::kEscape;
    if (map != nullptr) map->handle(event);
  }
  return ended;
}

// What happened, for live.json and the last lines on the screen.
struct Counts {
  std::vector<int> processed;  // numbers of the frames
  int touching = 0;
  std::optional<int> first_touch;
  int site_changes = 0;
  int last_site = -1;
  double deepest = 0;  // m
  SourceTroubles troubles;
  std::string last_trouble;
  std::vector<std::string> reports;  // of the source, in its words

  std::vector<int> lost;  // numbers of the frames in which the camera was
  int moving = 0;         // frames in which it was tracked

  void add(const Scene& scene) {
    processed.push_back(scene.number);
    if (scene.camera.state == TrackState::kLost) lost.push_back(scene.number);
    moving += scene.camera.state == TrackState::kTracking ? 1 : 0;
    if (scene.touches.empty()) return;
    const Touch& touch = scene.touches.front();
    ++touching;
    if (!first_touch) first_touch = scene.number;
    if (last_site >= 0 && last_site != touch.site) ++site_changes;
    last_site = touch.site;
    deepest = std::max(deepest, touch.press_depth);
  }
};

LiveSummary summary(const Options& options, const LiveRun& run, const Counts& counts,
                    const LiveOutput& output, double wall) {
  LiveSummary result;
  result.body = options.live.body.string();
  result.source = run.images.string();
  result.contact = options.live.contact;
  result.view = options.view;
  if (run.session.settings().ignore_static) {
    result.ignore_static_frames = run.session.settings().static_frames;
  }
  result.scale = options.live.scale;
  result.camera_from_body = run.session.camera_from_body();
  if (const auto& color = run.source->format().color_sensor) {
    result.color_from_depth = color->color_from_depth;
  }
  if (run.session.settings().track) {
    const TrackerCounts tracker = run.session.tracker_counts();
    result.tracking = {counts.moving, counts.lost,       tracker.recognised,
                       tracker.loops, tracker.keyframes, tracker.landmarks};
  }
  if (const SurfaceMap* map = run.session.map()) {
    result.map = {map->blocks(), map->refused(), run.session.free_space()->blocked()};
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
  result.color_scale = stress_scale(run.session.body());
  result.wall = wall;
  for (const auto& [stage, values] : output.times()) {
    if (!values.empty()) result.median_ms.emplace_back(stage, percentile(values, 0.5));
  }
  result.processed = counts.processed;
  return result;
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
  Session& session = run.session;
  Stage stage = make_stage(options.window, session.camera());
  SceneRenderer renderer = value_or_throw(SceneRenderer::make());
  std::unique_ptr<MapPicture> map;  // from outside, if it is to be shown
  if (options.view == "map") {
    map = std::make_unique<MapPicture>(value_or_throw(MapRenderer::make()),
                                       session.camera_from_body());
  }
  std::optional<LiveOutput> output;

  int total = run.source->frame_count();
  if (wanted.frames > 0) total = total > 0 ? std::min(total, wanted.frames) : wanted.frames;
  const double scale = stress_scale(session.body());
  Counts counts;
  ProgressBar bar;
  const auto begin = std::chrono::steady_clock::now();
  listen_for_ctrl_c();
  {
    VisionThread vision(*run.source, session, wanted.frames);
    Scene scene;
    ColorImage inside;  // what the camera sees, where the picture is the map's
    const auto hear = [&] {
      for (std::string& line : vision.take_reports()) {
        bar.finish();
        fmt::print(stderr, "{}\n", line);
        counts.reports.push_back(std::move(line));
      }
      counts.troubles = vision.troubles();
      counts.last_trouble = vision.last_trouble();
    };
    while (!vision.ended() && !asked_to_end()) {
      std::unique_ptr<FrameInFlight> flight = vision.next_within(FrameSource::kLongestWait);
      hear();
      if (!flight) {  // the picture and the body stay as they are
        if (stage.window && ended_by(*stage.window, map.get())) break;
        continue;
      }
      if (flight->seen.misfit) {
        throw Error(fmt::format("{}: {}", run.images.string(), flight->seen.misfit->message()));
      }
      if (!output) {  // not before: nothing that could be wrong with options or source was
        remove_earlier_run(earlier);
        output.emplace(LiveOutputSettings{.folder = options.out,
                                          .depth = !options.no_depth,
                                          .masks = !options.no_masks,
                                          .figures = options.pictures});
      }
      session.respond(flight->seen, scene);
      std::unique_ptr<DrawnFrame> drawn = output->blank();
      drawn->times = flight->times;
      drawn->times.add(scene.times);
      {
        const StageTimer timer(drawn->times, "draw");
        SceneView view = view_of(scene, session.body(), scale);
        if (map) {  // its own caption says it
          view.legend_title.clear();
          view.caption.clear();
          view.warning.clear();
        }
        renderer.draw(view, map ? inside : drawn->picture, &drawn->visible, &drawn->body_depth);
        if (map) {
          const MappedRoom room{session.body(), session.map(), session.camera_from_body(),
                                [&] { return session.keyframes(); }};
          map->draw(scene, room, scale, inside, drawn->picture);
        }
      }
      drawn->number = scene.number;
      drawn->time = scene.time;
      drawn->touches = scene.touches;
      drawn->camera_from_body = scene.camera_from_body;
      drawn->world_from_camera.reset();
      if (scene.camera.state != TrackState::kLost) {
        drawn->world_from_camera = scene.camera.world_from_camera;
      }
      if (!options.no_depth) {
        drawn->depth = scene.seen->depth;
        drawn->too_close = scene.seen->too_close;
      }
      drawn->moving.resize(0, 0);
      if (!options.no_masks && scene.moving != nullptr) drawn->moving = *scene.moving;
      drawn->row_error_px = scene.seen->row_error_px;
      drawn->row_correction_px = scene.seen->row_correction_px;
      if (options.pictures) {
        drawn->scores = figure_scores(scene, session.body(), drawn->visible, drawn->body_depth,
                                      session.pressing_depth());
      }
      counts.add(scene);
      vision.recycle(std::move(flight));

      if (stage.window) {
        stage.window->show(drawn->picture);
        if (ended_by(*stage.window, map.get())) total = static_cast<int>(counts.processed.size());
      }
      output->write(std::move(drawn));
      const auto done = static_cast<double>(counts.processed.size());
      if (total > 0) {
        bar.show({"live", done, static_cast<double>(total),
                  scene.touches.empty()
                      ? std::string("not touched")
                      : fmt::format("site {}, {:.1f} mm", scene.touches.front().site,
                                    scene.touches.front().press_depth * 1e3)});
      }
      if (total > 0 && done >= total) break;
    }
    hear();
  }
  bar.finish();
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  if (!output) {
    throw Error(fmt::format("{}: no frame could be read ({} unreadable; {})", run.images.string(),
                            counts.troubles.unreadable, counts.last_trouble));
  }
  output->finish();
  write_live_summary(options.out / "live.json",
                     summary(options, run, counts, *output, wall.count()));
  if (stage.errors().count() > 0) {
    throw Error(fmt::format("OpenGL reported {} errors, first: {}", stage.errors().count(),
                            stage.errors().first()));
  }

  fmt::print("{} frames in {:.1f} s ({:.0f} ms each), {} unreadable\n", counts.processed.size(),
             wall.count(), 1e3 * wall.count() / static_cast<double>(counts.processed.size()),
             counts.troubles.unreadable);
  if (counts.troubles.unreadable > 0) { fmt::print("last unreadable: {}\n", counts.last_trouble); }
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
