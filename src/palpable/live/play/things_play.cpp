#include "palpable/live/play/things_play.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/cpu_time.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/output_name.h"
#include "palpable/common/geometry/surface_mesh.h"
#include "palpable/live/live_writer/live_summary.h"
#include "palpable/live/play/nearest_approach.h"
#include "palpable/live/play/things_show.h"
#include "palpable/live/player/body_place.h"
#include "palpable/live/player/live_counts.h"
#include "palpable/live/player/run_stats.h"
#include "palpable/live/player/things_file.h"
#include "palpable/live/sources/frame_source.h"
#include "palpable/live/sources/wall_clock.h"
#include "palpable/live/things/pressed_bodies.h"
#include "palpable/live/view/stress_scale.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr double kLongestPause = 2;  // s; longer gaps of a paced file are shortened to this

std::vector<EventBody> event_bodies_of(const std::vector<PlacedBody>& standing) {
  std::vector<EventBody> bodies;
  for (const PlacedBody& body : standing) {
    const SurfaceMesh& skin = body.body.body.surface;
    bodies.push_back({.name = body.shown_name(),
                      .world_from_body = body.world_from_body,
                      .vertices = static_cast<int>(skin.vertices.cols()),
                      .triangles = static_cast<int>(skin.triangles.cols()),
                      .low = skin.vertices.rowwise().minCoeff(),
                      .high = skin.vertices.rowwise().maxCoeff()});
  }
  return bodies;
}

std::vector<LivePageBody> page_bodies_of(const std::vector<PlacedBody>& standing) {
  std::vector<EventBody> events = event_bodies_of(standing);
  std::vector<LivePageBody> bodies;
  for (std::size_t k = 0; k < standing.size(); ++k) {
    const ReducedBody& body = standing[k].body.body;
    bodies.push_back({std::move(events[k]), body.material, body.surface.triangles});
  }
  return bodies;
}

void check_bodies(const ThingsSetUp& setup) {
  for (std::size_t k = 0; k < setup.standing.size(); ++k) {
    if (setup.standing[k].body.touch) continue;
    throw Error(fmt::format(
        "{}: has no tables of touch, which pressing without a camera needs; bake it again without "
        "`tables = \"none\"` in [touch] (docs/body.md)",
        setup.bodies[k].file.string()));
  }
  if (const auto overlap = overlap_of(setup.standing)) throw Error(*overlap);
}

LiveOutputSettings output_of_things(const PlayOptions& options, const ThingsSetUp& setup,
                                    ThingsFrom from) {
  LiveOutputSettings settings;
  settings.folder = options.out;
  settings.files = {.film = options.files.film && from == ThingsFrom::kFile,
                    .data = options.files.data,
                    .depth = false,
                    .masks = false,
                    .meshes = options.files.meshes};
  read_frame_pictures(options.frame_pictures, settings);
  settings.has_camera = false;
  settings.complete = from == ThingsFrom::kFile;
  for (const PlacedBody& body : setup.standing) {
    if (setup.standing.size() > 1) settings.bodies.push_back(body.shown_name());
    if (options.files.meshes) settings.meshes_of.push_back(body.body.body.surface);
  }
  return settings;
}

// live.json, as far as it is known before the run.
LiveSummary summary_before(const ThingsSetUp& setup) {
  LiveSummary summary;
  summary.source = setup.source.string();
  summary.scene = setup.scene.string();
  for (std::size_t k = 0; k < setup.standing.size(); ++k) {
    const PlacedBody& standing = setup.standing[k];
    LiveSummary::Body& body = summary.bodies.emplace_back();
    body.name = standing.shown_name();
    body.file = setup.bodies[k].file.string();
    body.contact = "anywhere";
    body.takes_reactions = true;
    body.scale = setup.bodies[k].scale;
    if (standing.body.touch) body.friction = standing.body.touch->friction;
    body.camera_from_body = standing.world_from_body;
    summary.color_scale = std::max(summary.color_scale, stress_scale(standing.body.body));
  }
  return summary;
}

// The bodies of a run, and what presses them now.
class ThingsPress {
 public:
  ThingsPress(std::vector<PlacedBody> standing, bool dynamics) : dynamics_(dynamics) {
    std::vector<PressedBodies::Member> members;
    for (PlacedBody& body : standing) {
      poses_.push_back(body.world_from_body);
      members.push_back(
          {std::make_shared<const TouchableBody>(std::move(body.body)), poses_.back()});
      drawn_.push_back({members.back().body, poses_.back(), body.color});
    }
    bodies_ = std::make_unique<PressedBodies>(std::move(members));
  }

  [[nodiscard]] const std::vector<ThingsPicture::Body>& drawn() const { return drawn_; }

  // Fills all of a scene but its number.
  void press(const ThingsLine& line, Scene& scene) {
    const StageTimer timer(scene.times, "contact");
    things_in(line, things_);
    scene.things.clear();
    for (const CapsuleThing& thing : things_) scene.things.push_back(thing.id);
    scene.time = line.time;
    scene.camera = {};
    scene.camera.state = TrackState::kFixed;
    scene.bodies.resize(poses_.size());
    const ContactReport report =
        bodies_->advance(things_, scene.bodies, scene.touches, passed(line.time));
    for (std::size_t k = 0; k < poses_.size(); ++k) scene.bodies[k].camera_from_body = poses_[k];
    scene.mutual_penetration = report.mutual_penetration;
    scene.imbalance = report.imbalance;
    scene.left_to_move = report.unsolved();
    scene.inside = report.inside();
    scene.answer = report.reached();
    scene.contacts_dropped = report.dropped;
    scene.friction_residual = report.friction_residual;
    scene.ringing = report.ringing;
  }

  // Fills a scene with the bodies at rest. Results do not depend on whether it was called.
  void show_at_rest(Scene& scene) {
    press({}, scene);
    bodies_->forget();
    before_.reset();
  }

  [[nodiscard]] int passed_through() const { return bodies_->passed_through(); }

 private:
  // s since the line before; nothing without inertia.
  std::optional<double> passed(double time) {
    const double passed = before_ ? std::max(0.0, time - *before_) : 0.0;
    const bool stands = before_ && passed == 0;  // as where a client has left: nothing rings on
    before_ = time;
    return dynamics_ && !stands ? std::optional(passed) : std::nullopt;
  }

  std::vector<Rigid3> poses_;  // world_from_body
  std::vector<ThingsPicture::Body> drawn_;
  std::unique_ptr<PressedBodies> bodies_;
  std::vector<CapsuleThing> things_;
  bool dynamics_;
  std::optional<double> before_;  // s, of the line before
};

// Where a run's lines come from.
class ThingsLines {
 public:
  enum class Next { kLine, kWaiting, kEnd };

  virtual ~ThingsLines() = default;
  // Waits at most so long (s). A line that cannot be read ends a file: see lost().
  virtual Next next(ThingsLine& line, double longest) = 0;
  // Why the last line was not read; empty: the lines have ended.
  [[nodiscard]] virtual std::string lost() const { return {}; }
};

// The lines of a hands file, at their own pace if that is wanted.
class FileLines final : public ThingsLines {
 public:
  FileLines(const fs::path& file, bool paced) : file_(file), paced_(paced) {}

  Next next(ThingsLine& line, double longest) override {
    if (!has_line_) {
      try {
        if (!file_.next(line)) return Next::kEnd;
      } catch (const Error& error) {
        lost_ = error.what();
        return Next::kEnd;
      }
      has_line_ = true;
      wait_for(line.time);
    }
    if (paced_) {
      const double wait = due_ - system_clock().now();
      if (wait > 0) system_clock().sleep(std::min(wait, longest));
      if (wait > longest) return Next::kWaiting;
    }
    has_line_ = false;
    return Next::kLine;
  }

  [[nodiscard]] std::string lost() const override { return lost_; }

 private:
  void wait_for(double time) {
    due_ = time_ ? due_ + std::min(time - *time_, kLongestPause) : system_clock().now();
    time_ = time;
  }

  ThingsFile file_;
  bool paced_, has_line_ = false;
  double due_ = 0;              // s by the system's clock, when the line is to be played
  std::optional<double> time_;  // s, of that line
  std::string lost_;
};

// The lines of a client.
class ClientLines final : public ThingsLines {
 public:
  explicit ClientLines(LiveEvents& events) : events_(events) {}

  Next next(ThingsLine& line, double longest) override {
    switch (events_.next_things(line, longest)) {
      case LiveEvents::News::kNone:
        return Next::kWaiting;
      case LiveEvents::News::kThings:
        break;
      case LiveEvents::News::kReleased:  // nothing presses; the time stands still
        line.things.clear();
        line.capsules.clear();
        break;
    }
    return Next::kLine;
  }

 private:
  LiveEvents& events_;
};

std::unique_ptr<ThingsLines> lines_of(const ThingsSetUp& setup, ThingsFrom from,
                                      LiveEvents& events) {
  if (from == ThingsFrom::kClient) return std::make_unique<ClientLines>(events);
  return std::make_unique<FileLines>(setup.source, setup.paced);
}

bool draws(const PlayOptions& options, ThingsFrom from) {
  const bool in_files =
      (options.files.film && from == ThingsFrom::kFile) || !options.frame_pictures.empty();
  return options.window || (!options.out.empty() && in_files);
}

// The frame loop of a run without a camera.
class ThingsLoop {
 public:
  // @param scale  Pa, top of the colours
  ThingsLoop(const PlayOptions& options, const PlayUser& user, LiveEvents& events, LivePage& page,
             ThingsSetUp& setup, ThingsFrom from, double scale)
      : user_(user),
        events_(events),
        page_(page),
        lines_(lines_of(setup, from, events)),
        approach_(setup.standing),
        press_(std::move(setup.standing), setup.dynamics) {
    if (options.window || page_.is_served()) press_.show_at_rest(scene_);
    if (!draws(options, from)) return;
    show_.emplace(options, press_.drawn(), scale,
                  [this, body = setup.bodies.front().file](const ColorImage& picture) {
                    return user_.keep_picture(body, picture);
                  });
    if (options.window) show_->draw(scene_, {});
  }

  // @param begin_output  makes the output, or null; called before the first frame is written
  void play(int frames, const std::function<std::unique_ptr<LiveOutput>()>& begin_output) {
    page_.send_at_rest(scene_);  // until something presses
    while ((frames < 0 || frames_ < frames) && !user_.asked_to_end() && !window_ended()) {
      report_stats();
      // Drawn once a turn: with the next line, or at once if none is there.
      const bool turned = show_ && show_->handle_events();
      scene_.times.clear();
      const auto next = [&] {
        const StageTimer timer(scene_.times, "read");
        return lines_->next(line_, turned ? 0 : FrameSource::kLongestWait);
      }();
      if (next == ThingsLines::Next::kEnd) break;
      if (next == ThingsLines::Next::kWaiting) {
        if (turned) draw();
        events_.serve();
        page_.send_missed(frames_ > 0 ? &scene_ : nullptr);
        continue;
      }
      const double taken = system_clock().now();
      scene_.number = frames_++;
      press_.press(line_, scene_);
      if (!counts_.first_touch) approach_.add(line_);  // told if nothing is touched
      pressing_.assign(line_.capsules.begin(), line_.capsules.end());
      passed_through_ += press_.passed_through();
      counts_.add_contact(scene_);
      events_.send(scene_);
      page_.send(scene_);
      const ColorImage* picture = draw();
      stats_.add(scene_.times, 1e3 * (system_clock().now() - taken));
      if (frames_ == 1) output_ = begin_output();
      if (output_) write(picture);
    }
    if (show_) show_->throw_gl_errors();
  }

  [[nodiscard]] bool window_ended() const { return show_ && show_->ended(); }

  [[nodiscard]] const LiveCounts& counts() const { return counts_; }
  // Of the frames before the first touch.
  [[nodiscard]] const NearestApproach& approach() const { return approach_; }
  [[nodiscard]] LiveOutput* output() { return output_.get(); }
  [[nodiscard]] std::string lost() const { return lines_->lost(); }
  [[nodiscard]] RunFigures figures() const { return stats_.all(moment()); }
  // Sum over the frames.
  [[nodiscard]] int passed_through() const { return passed_through_; }

 private:
  // The picture of the scene; null if there is none.
  const ColorImage* draw() {
    if (!show_) return nullptr;
    const StageTimer timer(scene_.times, "draw");
    return &show_->draw(scene_, pressing_);
  }

  void write(const ColorImage* picture) {
    std::unique_ptr<DrawnFrame> drawn = output_->blank();
    if (picture != nullptr && drawn->in_files) drawn->picture = *picture;
    if ((show_ && show_->in_window()) || page_.is_served()) {
      // Needed again if the user turns the view, or a page comes, before the next line.
      drawn->scene = scene_;
    } else {
      std::swap(drawn->scene, scene_);
    }
    output_->write(std::move(drawn));
  }

  static RunMoment moment() { return {.now = system_clock().now(), .cpu = process_cpu_seconds()}; }

  void report_stats() {
    if (stats_.is_second_over(system_clock().now())) {
      user_.say(text_of(stats_.end_stretch(moment())));
    }
  }

  const PlayUser& user_;
  LiveEvents& events_;
  LivePage& page_;
  std::unique_ptr<ThingsLines> lines_;
  NearestApproach approach_;
  ThingsPress press_;
  ThingsLine line_;                // while a file's next line waits for its time, that one
  std::vector<Capsule> pressing_;  // those of scene_
  Scene scene_;
  std::optional<ThingsShow> show_;
  int frames_ = 0, passed_through_ = 0;
  LiveCounts counts_;
  RunStats stats_{moment()};
  std::unique_ptr<LiveOutput> output_;
};

const fs::path& checked_folder(const PlayOptions& options) {
  require_folder_name(options.out);
  return options.out;
}

std::string text_of_run(const ThingsLoop& loop, double wall) {
  const LiveCounts& counts = loop.counts();
  const std::size_t frames = counts.processed.size();
  std::string text = fmt::format("{} frames in {:.1f} s ({:.0f} ms each)\n", frames, wall,
                                 1e3 * wall / static_cast<double>(frames));
  text += text_of_contact(counts);
  if (!counts.first_touch) text += loop.approach().text();
  if (loop.passed_through() > 0) {
    text += fmt::format(
        "{} times a capsule went through a skin: from line to line it should advance by less than "
        "its radius\n",
        loop.passed_through());
  }
  return text;
}

}  // namespace

ThingsPlay::ThingsPlay(const PlayOptions& options, const std::vector<fs::path>& inputs,
                       PlayUser user, ThingsFrom from)
    : from_(from),
      options_(options),
      user_(std::move(user)),
      folder_(checked_folder(options_), options_.overwrite, inputs),
      events_(options.events, from == ThingsFrom::kClient),
      page_(options.serve) {
  PALPABLE_EXPECT(from == ThingsFrom::kFile || options.events != kNoEvents, "clients need events");
}

PlayResult ThingsPlay::play(ThingsSetUp& setup, int frames) {
  check_bodies(setup);
  const LiveOutputSettings written = output_of_things(options_, setup, from_);
  LiveSummary all = summary_before(setup);
  const std::vector<EventBody> bodies = event_bodies_of(setup.standing);
  const std::vector<LivePageBody> page_bodies = page_bodies_of(setup.standing);
  ThingsLoop loop(options_, user_, events_, page_, setup, from_, all.color_scale);

  const auto begin = std::chrono::steady_clock::now();
  user_.begin();
  events_.begin(bodies, EventWorld::kOfThings);
  if (!events_.name().empty()) user_.print(fmt::format("events: {}\n", events_.name()));
  page_.begin(page_bodies, {.world = EventWorld::kOfThings, .stress_top = all.color_scale});
  if (page_.is_served()) user_.print(fmt::format("page: {}\n", page_.url()));
  loop.play(frames, [&] { return folder_.begin(written); });
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  if (loop.counts().processed.empty()) {
    if (!loop.lost().empty()) throw Error(loop.lost());
    throw Error(
        fmt::format("{}: {}", setup.source.string(),
                    from_ == ThingsFrom::kFile ? "has no line" : "no client has sent a line"));
  }
  if (loop.output() != nullptr) loop.output()->finish();
  const RunFigures figures = loop.figures();
  add_contact(loop.counts(), figures, loop.output(), all);
  all.wall = wall.count();
  if (loop.output() != nullptr) folder_.write(all);
  PlayResult result;
  result.text = text_of_run(loop, wall.count()) + events_.text() + page_.text();
  if (options_.stats) result.text += text_of(figures) + "\n";
  if (loop.output() != nullptr) result.text += folder_.text_of(*loop.output());
  result.summary = json_of(all);
  result.user_ended = user_.asked_to_end() || loop.window_ended();
  result.lost = loop.lost();
  return result;
}

}  // namespace palpable
