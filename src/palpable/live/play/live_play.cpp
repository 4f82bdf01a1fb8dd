#include "palpable/live/play/live_play.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/cpu_time.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/file_format.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/output_name.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/base/this_machine.h"
#include "palpable/desk/clip_files/image_files.h"
#include "palpable/desk/clip_files/scene_files.h"
#include "palpable/live/live_writer/live_output.h"
#include "palpable/live/live_writer/live_summary.h"
#include "palpable/live/play/live_changes.h"
#include "palpable/live/player/body_place.h"
#include "palpable/live/player/contact_ticks.h"
#include "palpable/live/player/live_loop.h"
#include "palpable/live/player/run_stats.h"
#include "palpable/live/sources/recording_file.h"
#include "palpable/live/sources/wall_clock.h"
#include "palpable/live/view/figure_scores.h"
#include "palpable/live/view/painted_stress.h"
#include "palpable/live/view/scene_painter.h"
#include "palpable/live/view/scene_picture.h"
#include "palpable/live/view/show_names.h"
#include "palpable/live/view/stress_scale.h"
#include "palpable/live/view/tiles.h"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr double kPauseWait = 0.05;  // s, wait for window events while a recording is paused

// Whether files or the window need the picture of every frame.
[[nodiscard]] bool needs_pictures(const PlayOptions& options) {
  const RunFiles& files = options.files;
  const bool in_files =
      files.film || files.masks || files.stills || !options.frame_pictures.empty();
  return options.window || (!options.out.empty() && in_files);
}

// Whether pictures are drawn at all: those of a page alone only while somebody looks at it.
[[nodiscard]] bool has_pictures(const PlayOptions& options) {
  return needs_pictures(options) || options.serve.has_value();
}

// Fails before bodies are read if the recording cannot be written.
fs::path checked_recording(const fs::path& record, const std::vector<fs::path>& inputs,
                           bool overwrite) {
  if (record.empty()) return record;
  const std::string file = record.string();
  if (!is_recording_name(record)) {
    throw Error(fmt::format("--record {}: should end in {}", file, kRecordingEnding));
  }
  guard_output_file(record, inputs);
  std::error_code ignored;
  if (fs::exists(record, ignored) && !overwrite) {
    throw Error(fmt::format("--record {}: is there already; --overwrite replaces it", file));
  }
  guard_format(record, FileFormat::kRecording);
  return record;
}

// Whether several views are shown side by side. A mask or the truth is a tile even if alone.
[[nodiscard]] bool is_tiled(const PlayOptions& options) {
  return options.view.size() != 1 ||
         std::find(kViewNames.begin(), kViewNames.end(), options.view.front()) == kViewNames.end();
}

// Returns the options if they do not contradict each other. @param other_output whether --overwrite
// also applies to another file
const PlayOptions& checked(const PlayOptions& options, bool other_output) {
  if (options.files.stills && options.view != std::vector<std::string>{"camera"}) {
    throw Error(fmt::format("--write stills: they are what the camera sees; leave out --view {}",
                            fmt::join(options.view, " ")));
  }
  if (options.view.size() > kTileNames.size()) {
    throw Error(fmt::format("--view: at most {} views fit side by side", kTileNames.size()));
  }
  if (is_tiled(options) && options.window) {
    throw Error("--view: the --window shows one view, and switches it");
  }
  if (options.out.extension() == ".mp4") {
    throw Error(
        fmt::format("--out {}: is the folder for all files; the film alone: --out DIR "
                    "--write film",
                    options.out.string()));
  }
  require_folder_name(options.out);
  if (options.paused && !options.window) throw Error("--paused: a --window is paused");
  if (!options.out.empty()) return options;
  // Options about written files are an error without --out.
  for (const auto& [wanted, name] :
       {std::pair{options.files != RunFiles{}, "--write"},
        std::pair{!options.frame_pictures.empty(), "--frame-pictures"},
        std::pair{options.overwrite && !other_output, "--overwrite"},
        std::pair{is_tiled(options) && !options.serve, "--view with several views"},
        std::pair{options.every_frame, "--every-frame"}}) {
    if (wanted) throw Error(fmt::format("{}: without --out nothing is written", name));
  }
  return options;
}

ProgressReport progress_of(const Scene& scene, int done, int total) {
  return {"live", static_cast<double>(done), static_cast<double>(total), caption_of(scene.touches)};
}

std::vector<Tile> tiles_of(const PlayOptions& options) {
  std::vector<Tile> tiles;
  if (!is_tiled(options)) return tiles;
  for (const std::string& name : options.view) tiles.push_back(value_named<Tile>(name, kTileNames));
  return tiles;
}

// The true depths that a synthetic clip has beside its pictures. @param images its folder frames/
// @throws Error if there are none
std::function<std::optional<DepthImage>(int)> true_depths(const fs::path& images) {
  const fs::path truth = (fs::absolute(images) / ".." / "truth").lexically_normal();
  std::error_code ignored;
  if (!fs::is_directory(images, ignored) || !fs::is_directory(truth / "depth", ignored)) {
    throw Error(
        fmt::format("--view truth: {} has no truth/depth beside it; films of palpable "
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
  show.colors = value_named<ColorScale>(options.colors, kColorScaleNames);
  show.blended = !options.opaque;
  show.occlusion = value_named<SceneShow::Occlusion>(options.occlusion, kOcclusionNames);
  show.contacts = show.forces = options.forces;
  return show;
}

// Warns of a body that is far too large for the view, or outside of it: nothing would touch it.
void warn_of_place(const LiveRun& run, const PlayUser& user) {
  const Session& session = run.loop.session;
  for (int k = 0; k < session.body_count(); ++k) {
    const SurfaceMesh& skin = session.body(k).model().surface;
    const Rigid3& world_from_body = session.body(k).world_from_body;
    for (const auto& warning : {larger_than_view(skin, world_from_body, run.loop.camera.camera()),
                                outside_of_view(skin, world_from_body, run.loop.camera.camera())}) {
      if (warning) user.say(fmt::format("warning: {}", *warning));
    }
  }
}

// Says of a body whose bake has not ended what is missing.
void note_stages(const LiveSetUp& setup, const PlayUser& user) {
  const Session& session = setup.run.loop.session;
  for (int k = 0; k < session.body_count(); ++k) {
    const Provenance& provenance = session.body(k).model().provenance;
    if (provenance.stage == BodyStage::kFinished) continue;
    const std::string& command = provenance.command_line;
    user.say(fmt::format("{}: its bake has not ended: {}; {} goes on: {}",
                         setup.bodies[static_cast<std::size_t>(k)].file.string(),
                         missing_at(provenance.stage),
                         command.find("--until") == std::string::npos ? "the same command"
                                                                      : "the same without --until",
                         command));
  }
}

// Computes touches between frames; null if that is not wanted.
std::unique_ptr<ContactTicks> ticks_of(const PlayOptions& options, const LiveRun& run,
                                       LiveEvents& events, LivePage& page) {
  if (options.contact_rate == 0) return nullptr;
  return std::make_unique<ContactTicks>(
      run.loop.session,
      ContactTicks::Settings{.rate = options.contact_rate,
                             .when_due = run.source->is_live() || options.paced},
      [&events, &page](const ContactTick& tick) {
        events.send(tick.frame, tick.number, tick.time, *tick.touches);
        page.send(tick.frame, tick.number, tick.time, *tick.touches);
      });
}

// Greets clients, who connect from now on, with a session.
void begin_clients(LiveEvents& events, LivePage& page, const Session& session) {
  events.begin(session);
  if (!page.is_served()) return;
  page.begin(live_page_bodies(session), {.world = EventWorld::kFirstCamera,
                                         .stress_top = stress_scale(session),
                                         .has_picture = true});
}

// What a frame loop works with; must outlive it.
struct LoopParts {
  const PlayOptions& options;
  const PlayUser& user;
  LiveRun& run;
  ScenePainter* painter;  // null: nothing is drawn
  LiveEvents& events;
  LivePage& page;
  StateWatch& watch;
  LiveChanges* changes;  // null: the run cannot be changed
  // Makes the output, or null; called after the first frame was processed, so that a run that
  // cannot begin replaces no files.
  std::function<std::unique_ptr<LiveOutput>()> begin_output;
};

struct Played {
  LiveCounts counts;
  RunFigures figures;
  std::unique_ptr<LiveOutput> output;  // null: no output, or no frame came
  bool user_ended = false;
  std::optional<ContactTickFigures> ticks;
};

// The frame loop of a run.
class PlayLoop {
 public:
  PlayLoop(const LoopParts& parts, int frames)
      : with_(parts),
        loop_(parts.run, frames, parts.user.say),
        ticks_(ticks_of(parts.options, parts.run, parts.events, parts.page)) {}

  // Plays until the source or the user ends the run. To be called once.
  Played play() {
    while ((!loop_.ended() || waits()) && !user_ended()) {
      if (with_.changes != nullptr && with_.changes->record(*with_.painter, loop_)) {
        has_last_ = false;
        begin_clients(with_.events, with_.page, session_);
      }
      if (waits()) {
        hold(kPauseWait);
        continue;
      }
      with_.run.loop.session.keep(with_.painter != nullptr ? with_.painter->wants()
                                                           : SceneExtras{});
      Scene* scene = loop_.next_within(FrameSource::kLongestWait);
      report_stats();
      if (scene != nullptr) {
        publish(*scene);
        draw_and_write(*scene);
      } else {
        hold(0);
      }
    }
    RunFigures figures = stats_.all(moment());
    loop_.finish();
    Played played{loop_.counts(), std::move(figures), std::move(output_), user_ended(), {}};
    if (ticks_) played.ticks = ticks_->finish();
    return played;
  }

 private:
  [[nodiscard]] bool user_ended() const {
    return with_.user.asked_to_end() || (with_.painter != nullptr && with_.painter->ended());
  }

  // A recording stops while it is paused; frames of a camera are still processed, but not shown.
  [[nodiscard]] bool waits() const {
    return !is_live_ && with_.painter != nullptr && with_.painter->holds();
  }

  // Without a new frame, picture and body stay unchanged.
  void hold(double wait) {
    if (with_.painter != nullptr) with_.painter->handle_events(wait);
    with_.events.serve();
    send_missed();
  }

  // Sends the last frame to pages that have come since.
  void send_missed() {
    if (!with_.page.is_any_new()) return;
    const Scene* last = nullptr;
    if (has_last_) last = output_ ? &last_ : &kept_->scene;
    if (!with_.page.send_missed(last) || with_.painter == nullptr) return;
    if (waits()) {
      with_.page.send_picture(with_.painter->held_picture());
    } else if (!output_) {  // else a thread may be writing it
      if (!is_kept_drawn_) is_kept_drawn_ = with_.painter->draw(*kept_, session_, false, true);
      if (is_kept_drawn_) with_.page.send_picture(kept_->picture);
    }
  }

  RunMoment moment() {
    return {.now = system_clock().now(),
            .cpu = process_cpu_seconds(),
            .dropped = loop_.counts().troubles.dropped,
            .left_out = output_ ? output_->left_out() : 0};
  }

  void report_stats() {
    // Without pictures and without a known number of frames, statistics are the only sign of
    // progress.
    const bool wanted = with_.options.stats || (!needs_pictures_ && loop_.total() <= 0);
    if (wanted && stats_.is_second_over(system_clock().now())) {
      with_.user.say(text_of(stats_.end_stretch(moment())));
    }
  }

  // Applies the user's changes, then hands the frame's results to the events, to the ticks between
  // frames and to the recording.
  void publish(Scene& scene) {
    if (with_.changes != nullptr && with_.changes->apply(*with_.painter, scene)) {
      begin_clients(with_.events, with_.page, session_);
    }
    if (ticks_) ticks_->end_frame();
    with_.events.send(scene);
    with_.page.send(scene);
    if (ticks_) ticks_->begin_frame(session_, scene);
    if (const auto line = with_.watch.add(scene)) with_.user.say(*line);
  }

  void draw_and_write(Scene& scene) {
    if (!output_) output_ = with_.begin_output();
    std::unique_ptr<DrawnFrame> drawn = output_ ? output_->blank() : std::move(kept_);
    std::swap(drawn->scene, scene);
    is_kept_drawn_ = false;
    if (with_.painter != nullptr) {
      const bool for_page = with_.page.wants_picture();
      const bool is_drawn = with_.painter->draw(*drawn, session_, needs_pictures_, for_page);
      if (is_drawn && for_page) with_.page.send_picture(drawn->picture);
      is_kept_drawn_ = is_drawn;
      with_.painter->show(drawn->picture);
    }
    stats_.add(drawn->scene.times, 1e3 * (system_clock().now() - loop_.taken()));
    if (with_.options.files.stills && drawn->in_files) {
      drawn->scores = figure_scores(drawn->scene, session_, drawn->visible, drawn->body_depth);
    }
    const int done = static_cast<int>(loop_.counts().processed.size());
    const int total = user_ended() ? done : loop_.total();
    if (total > 0) report(with_.user.progress, progress_of(drawn->scene, done, total));
    has_last_ = true;
    if (output_) {
      if (with_.page.is_served()) keep_for_page(drawn->scene, last_);
      output_->write(std::move(drawn));
    } else {
      kept_ = std::move(drawn);
    }
  }

  LoopParts with_;
  const Session& session_ = with_.run.loop.session;
  bool is_live_ = with_.run.source->is_live();
  bool needs_pictures_ = needs_pictures(with_.options);
  RunStats stats_{{.now = system_clock().now(), .cpu = process_cpu_seconds()}};
  LiveLoop loop_;
  std::unique_ptr<ContactTicks> ticks_;  // null: none between frames
  std::unique_ptr<LiveOutput> output_;
  std::unique_ptr<DrawnFrame> kept_ = std::make_unique<DrawnFrame>();  // reused without output
  bool is_kept_drawn_ = false;  // whether kept_->picture is that of its scene
  // Of the last frame of the session, where a page may come later: in kept_ without output.
  bool has_last_ = false;
  Scene last_;
};

LiveSummary summary(const PlayOptions& options, const LiveSetUp& setup, const Played& played,
                    double wall) {
  LiveSummary result = summary_of(setup.run, played.counts, played.figures, played.output.get());
  result.view = fmt::format("{}", fmt::join(options.view, ","));
  result.scene = setup.scene.string();
  for (std::size_t k = 0; k < result.bodies.size(); ++k) {
    result.bodies[k].file = setup.bodies[k].file.string();
    result.bodies[k].scale = setup.bodies[k].scale;
  }
  result.wall = wall;
  return result;
}

LiveOutputSettings output_settings(const PlayOptions& options, const LiveRun& run) {
  const Session& session = run.loop.session;
  LiveOutputSettings settings;
  settings.folder = options.out;
  settings.starts_at = run.source->format().starts_at;
  settings.complete = options.every_frame || !run.source->is_live();
  settings.files = options.files;
  read_frame_pictures(options.frame_pictures, settings);
  for (int k = 0; k < session.body_count(); ++k) {
    if (session.body_count() > 1) settings.bodies.push_back(session.body(k).name);
    if (options.files.meshes) settings.meshes_of.push_back(session.body(k).model().surface);
  }
  if (options.files.stills) settings.touch_frames = truly_touching_frames(run.images);
  return settings;
}

std::unique_ptr<ScenePainter> painter_of(const PlayOptions& options, const LiveSetUp& setup,
                                         const PlayUser& user, bool run_may_change) {
  if (!has_pictures(options)) return nullptr;
  const bool masks = !options.out.empty() && (options.files.masks || options.files.stills);
  const std::vector<Tile> tiles = tiles_of(options);
  const bool truth = std::find(tiles.begin(), tiles.end(), Tile::kTruth) != tiles.end();
  return std::make_unique<ScenePainter>(
      ScenePainterSettings{
          .window = options.window,
          .view = tiles.empty() ? value_named<LiveView>(options.view.front(), kViewNames)
                                : LiveView::kCamera,
          .show = show_of(options),
          .paused = options.paused,
          .masks = masks,
          .run_may_change = run_may_change,
          .tiles = tiles,
          .true_depth = truth ? true_depths(setup.run.images) : nullptr,
          .keep_picture =
              [&user, body = setup.bodies.front().file](const ColorImage& picture) {
                return user.keep_picture(body, picture);
              }},
      setup.run.loop);
}

// What depth/ cannot hold although it was measured; empty: hardly anything. A scene that is too
// large, such as by a baseline in centimetres, leaves its images empty.
std::string text_of_depth_files(const LiveSummary::Depth& depth) {
  constexpr double kHardlyAny = 0.05;  // share of the pixels, as in depth_survey.h
  if (!depth.written || *depth.written >= kHardlyAny || depth.kept < kHardlyAny) return {};
  return fmt::format(
      "warning: depth/ has a depth in {:.0f} % of the pixels, although {:.0f} % are known: its "
      "numbers end at {:.3g} m, and the median is {:.3g} m; is the unit of the depth or of the "
      "calibration right?\n",
      100 * *depth.written, 100 * depth.kept, 65534 * kDepthUnit, depth.median);
}

// Compares the states of a replay with those of the live run.
class ReplayWatch final : public StateWatch {
 public:
  explicit ReplayWatch(StateComparison& comparison) : comparison_(comparison) {}
  std::optional<std::string> add(const Scene& scene) override {
    const std::uint64_t state = state_hash(scene);
    hash_.add(state);
    comparison_.add(scene.number, state);
    return std::nullopt;
  }
  std::optional<LiveSummary::States> end() override {
    return LiveSummary::States{hash_.text(), hash_.count()};
  }

 private:
  StateComparison& comparison_;
  RunHash hash_;
};

}  // namespace

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

LivePlay::LivePlay(const PlayOptions& options, const std::vector<fs::path>& inputs, PlayUser user,
                   const fs::path& record)
    : record_(checked_recording(record, inputs, options.overwrite)),
      options_(checked(options, !record.empty())),
      user_(std::move(user)),
      folder_(options_.out, options_.overwrite, inputs),
      events_(options_.events),
      page_(options_.serve) {}

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

PlayResult LivePlay::play(LiveSetUp& setup, int frames) {
  check(setup);  // before an earlier recording is replaced
  LiveChanges changes(setup, user_);
  if (!record_.empty()) {
    changes.begin_recording(record_, options_.overwrite ? Opening::kAlone : Opening::kNew);
  }
  const bool may_change =
      options_.window && setup.options.refine.empty() && options_.contact_rate == 0;
  PlayResult result = run(setup, frames, changes, may_change ? &changes : nullptr);
  result.text += changes.text();
  result.lost = changes.lost();
  return result;
}

PlayResult LivePlay::replay(LiveSetUp& setup, StateComparison& comparison) {
  check(setup);
  ReplayWatch watch(comparison);
  return run(setup, comparison.expected() > 0 ? comparison.expected() : -1, watch, nullptr);
}

PlayResult LivePlay::run(LiveSetUp& setup, int frames, StateWatch& watch, LiveChanges* changes) {
  LiveRun& run = setup.run;
  note_stages(setup, user_);
  warn_of_place(run, user_);
  const LiveOutputSettings written = output_settings(options_, run);
  const std::unique_ptr<ScenePainter> painter =
      painter_of(options_, setup, user_, changes != nullptr);

  const auto begin = std::chrono::steady_clock::now();
  user_.begin();
  begin_clients(events_, page_, run.loop.session);
  if (!events_.name().empty()) user_.print(fmt::format("events: {}\n", events_.name()));
  if (page_.is_served()) user_.print(fmt::format("page: {}\n", page_.url()));
  const auto begin_output = [&] { return folder_.begin(written); };
  const Played played =
      PlayLoop({options_, user_, run, painter.get(), events_, page_, watch, changes, begin_output},
               frames)
          .play();
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  const LiveCounts& counts = played.counts;
  if (counts.processed.empty()) {
    throw Error(fmt::format("{}: no frame could be read ({} unreadable; {})", run.images.string(),
                            counts.troubles.unreadable, counts.last_trouble));
  }
  const std::optional<LiveSummary::States> states = watch.end();
  if (played.output) played.output->finish();
  LiveSummary all = summary(options_, setup, played, wall.count());
  all.states = states;
  if (played.output) folder_.write(all);
  if (painter) painter->throw_gl_errors();

  std::string text = text_of(counts, run.loop.session, wall.count());
  if (states) text += fmt::format("states: {} of {} frames\n", states->hash, states->frames);
  text += events_.text();
  text += page_.text();
  if (played.ticks) text += text_of(*played.ticks) + "\n";
  if (options_.stats) text += text_of(played.figures) + "\n";
  text += text_of_depth_files(all.depth);
  if (played.output) text += folder_.text_of(*played.output, "--every-frame waits for it");
  return {.text = std::move(text), .summary = json_of(all), .user_ended = played.user_ended};
}

}  // namespace palpable
