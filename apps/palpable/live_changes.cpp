#include "apps/palpable/live_changes.h"

#include "apps/palpable/recorded_run.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/live/player/anchoring.h"
#include "palpable/live/player/body_place.h"
#include "palpable/live/player/live_run.h"
#include "palpable/live/player/state_hash.h"

#include <fmt/chrono.h>
#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <utility>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

// In the current folder, with the body's name and the time of day.
fs::path usual_recording(const fs::path& body) {
  fs::path file = fmt::format("{}_{:%Y-%m-%d_%H-%M-%S}{}", body.stem().string(),
                              fmt::localtime(std::time(nullptr)), kRecordingEnding);
  std::error_code ignored;
  if (fs::exists(file, ignored)) throw Error(fmt::format("{}: is there already", file.string()));
  return file;
}

}  // namespace

Recording::Recording(const fs::path& file, const LiveOptions& options, LiveSetUp& setup)
    : file_(file),
      lines_(event_bodies(setup.run.loop.session)),
      recorder_(file_, setup.run.source->format(), json_of_run(recorded_run(options, setup))),
      refiner_(setup.run.loop.session.refiner()) {
  setup.run.source = recorded(std::move(setup.run.source), recorder_);
  fmt::print("recording {}: it holds pictures of your room\n", file_.string());
  std::fflush(stdout);
}

std::optional<std::string> Recording::add(const Scene& scene) {
  const bool refines =
      refiner_ != nullptr && (refiner_->asked() || refiner_->taken_up() != nullptr);
  if (refines) recorder_.add_refinement(refiner_->asked(), refiner_->taken_up());
  recorder_.add_state(scene.number, state_hash(scene), lines_.line_of(scene));
  return recorder_.take_trouble();
}

LiveSummary::States Recording::finish() {
  counts_ = recorder_.finish();
  finished_ = true;
  trouble_ = recorder_.take_trouble().value_or("");
  return {counts_.states.text(), counts_.states.count()};
}

void Recording::report() const {
  if (!trouble_.empty()) fmt::print(stderr, "{}\n", trouble_);
  if (counts_.left_out > 0) {
    fmt::print("{} frames were left out of recording and run: the disk was behind\n",
               counts_.left_out);
  }
  fmt::print("{}: {} frames, {:.1f} MB, pictures of your room; palpable replay plays it\n",
             file_.string(), counts_.frames, 1e-6 * static_cast<double>(counts_.bytes));
  std::fflush(stdout);
}

LiveChanges::LiveChanges(const LiveOptions& options, LiveSetUp& setup)
    : options_(options), setup_(setup) {
  for (const DescribedBody& body : setup.bodies) set_at_first_.push_back(body.set);
}

bool LiveChanges::possible(const LiveOptions& options, const PlayOptions& play) {
  return play.window && options.refine.empty() && play.contact_rate == 0;
}

void LiveChanges::begin_recording(const fs::path& file) {
  recording_.emplace(file, options_, setup_);
}

StateWatch LiveChanges::watch() {
  return {[this](const Scene& scene) -> std::optional<std::string> {
            camera_from_body_.resize(scene.bodies.size());
            for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
              camera_from_body_[k] = scene.bodies[k].camera_from_body;
            }
            return records() ? recording_->add(scene) : std::nullopt;
          },
          [this]() -> std::optional<LiveSummary::States> {
            if (!records()) return std::nullopt;
            ended_with_run_ = true;
            return recording_->finish();
          }};
}

void LiveChanges::report() const {
  if (ended_with_run_) recording_->report();
}

// The source remains wrapped and passes frames on until the next recording.
std::string LiveChanges::end_recording() {
  recording_->finish();
  recording_->report();
  return fmt::format("{} is written", recording_name());
}

void LiveChanges::plan_place(const LiveControls& controls, const Scene* held, const Scene& scene,
                             Plan& plan) const {
  const Scene& clicked = held != nullptr ? *held : scene;
  const std::optional<Rigid3> found =
      pose_at_pixel(clicked.seen, setup_.run.loop.camera.noise(), *controls.wishes.place);
  if (!found) throw Error("no surface is known there: click beside it");
  if (clicked.camera.state == TrackState::kLost || scene.camera.state == TrackState::kLost) {
    throw Error("where the camera is is not known: it is lost");
  }
  const Rigid3 camera_from_place =
      scene.camera.world_from_camera.inverse() * clicked.camera.world_from_camera * *found;
  if (controls.body >= 0) {
    plan.world_from_body[static_cast<std::size_t>(controls.body)] = camera_from_place;
    return;
  }
  const Rigid3 moved = camera_from_place * plan.world_from_body.front().inverse();
  for (Rigid3& pose : plan.world_from_body) pose = moved * pose;
}

void LiveChanges::plan_values(const LiveControls& controls, Plan& plan) const {
  for (std::vector<std::string>& set : plan.set) set.clear();
  for (const LiveParameter& parameter : controls.parameters) {
    plan.set[static_cast<std::size_t>(parameter.body)].push_back(
        fmt::format("{}={}", parameter.name, parameter.value));
  }
}

// Bodies with other values are read again: a body in memory is already evaluated at its values.
void LiveChanges::plan_bodies(Plan& plan) const {
  for (std::size_t k = 0; k < plan.set.size(); ++k) {
    DescribedBody body = setup_.bodies[k];
    if (plan.set[k] == body.set) continue;
    body.set = plan.set[k];
    plan.read[k] = read_live_body(body, options_.contact);
    if (body.scale != 1) plan.read[k] = scaled(*plan.read[k], body.scale);
  }
}

LiveChanges::Plan LiveChanges::plan_of(const LiveControls& controls, const Scene* held,
                                       const Scene& scene) const {
  Plan plan;
  std::vector<BodyPlace> places;
  for (std::size_t k = 0; k < setup_.bodies.size(); ++k) {
    plan.world_from_body.push_back(scene.bodies[k].camera_from_body);
    plan.set.push_back(controls.wishes.anew ? set_at_first_[k] : setup_.bodies[k].set);
    places.push_back(setup_.bodies[k].place);
  }
  plan.read.resize(setup_.bodies.size());
  if (!controls.wishes.anew) {
    if (controls.wishes.parameters) plan_values(controls, plan);
    if (controls.wishes.place) plan_place(controls, held, scene, plan);
  }
  plan_bodies(plan);
  if (!controls.wishes.anew) return plan;
  std::vector<const SurfaceMesh*> skins;
  for (std::size_t k = 0; k < setup_.bodies.size(); ++k) {
    skins.push_back(plan.read[k]
                        ? &plan.read[k]->body.surface
                        : &setup_.run.loop.session.body(static_cast<int>(k)).model().surface);
  }
  plan.world_from_body = places_anew(places, skins, setup_.settings, setup_.run.images, scene.seen,
                                     setup_.run.loop.camera.noise());
  return plan;
}

void LiveChanges::begin_session(std::vector<PlacedBody> bodies) {
  FrameLoop& loop = setup_.run.loop;
  const SceneExtras extras = loop.session.kept();
  loop.session = value_or_throw(Session::make(
      std::move(bodies), loop.camera, setup_.run.source->format(), loop.session.settings()));
  loop.session.keep(extras);
}

void LiveChanges::apply(ScenePainter& painter, Scene& scene, LiveEvents& events) {
  LiveControls& controls = painter.controls();
  if (!controls.wishes.of_frame()) return;
  Session& session = setup_.run.loop.session;
  std::string note;
  try {
    Plan plan = plan_of(controls, painter.held(), scene);
    if (records()) note = end_recording();
    painter.panel().recording.clear();
    std::vector<PlacedBody> bodies = session.take_bodies();
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      bodies[k].world_from_body = plan.world_from_body[k];
      if (plan.read[k]) bodies[k].body = std::move(*plan.read[k]);
      setup_.bodies[k].set = std::move(plan.set[k]);
    }
    if (const auto overlap = overlap_of(bodies)) {
      note = *overlap;
      for (std::size_t k = 0; k < bodies.size(); ++k) {
        bodies[k].world_from_body = scene.bodies[k].camera_from_body;
      }
    }
    begin_session(std::move(bodies));
    session.respond(scene);
    painter.begin_anew();
    events.begin_anew(session);
  } catch (const Error& error) {
    note = error.what();
    controls.placing = controls.wishes.place.has_value();
    painter.gather_parameters();
  }
  controls.wishes = {.recording = controls.wishes.recording};  // for record()
  painter.panel().note = std::move(note);
}

void LiveChanges::record(ScenePainter& painter, LiveLoop& loop, LiveEvents& events) {
  LiveWishes& wishes = painter.controls().wishes;
  LivePanel& panel = painter.panel();
  if (records()) panel.recording = recording_name();  // begun by --record
  if (!wishes.recording) return;
  wishes.recording = false;
  if (records()) {
    panel.recording.clear();
    panel.note = end_recording();
    painter.refresh_panel();
    return;
  }
  if (camera_from_body_.empty()) return;  // no frame was processed yet: try again later
  try {
    const fs::path file = usual_recording(setup_.bodies.front().file);
    loop.begin_anew([&](LiveRun& run) { begin_recorded_session(file, run); });
    panel.note.clear();
  } catch (const Error& error) { panel.note = error.what(); }
  if (records()) panel.recording = recording_name();
  painter.begin_anew();
  painter.refresh_panel();
  events.begin_anew(setup_.run.loop.session);
}

// Starts with a new camera without a learnt row correction, as a replay does.
void LiveChanges::begin_recorded_session(const fs::path& file, LiveRun& run) {
  std::vector<PlacedBody> bodies = run.loop.session.take_bodies();
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    bodies[k].world_from_body = camera_from_body_[k];
  }
  run.loop.camera =
      value_or_throw(DepthCamera::make(run.source->format(), run.loop.session.settings().depth));
  begin_session(std::move(bodies));
  if (recording_) {
    run.source = unrecorded(std::move(run.source));
    recording_.reset();
  }
  recording_.emplace(file, options_, setup_);
}

}  // namespace palpable::app
