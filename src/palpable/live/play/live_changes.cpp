#include "palpable/live/play/live_changes.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/live/player/anchoring.h"
#include "palpable/live/player/body_place.h"
#include "palpable/live/player/live_run.h"
#include "palpable/live/player/state_hash.h"

#include <fmt/chrono.h>
#include <fmt/core.h>

#include <algorithm>
#include <ctime>
#include <utility>

namespace palpable {
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

// The values of the panel's parameters for each body, NAME=VALUE.
std::vector<std::vector<std::string>> set_of(const LiveControls& controls, std::size_t bodies) {
  std::vector<std::vector<std::string>> set(bodies);
  for (const LiveParameter& parameter : controls.parameters) {
    set[static_cast<std::size_t>(parameter.body)].push_back(
        fmt::format("{}={}", parameter.name, parameter.value));
  }
  return set;
}

}  // namespace

RunRecording::RunRecording(const fs::path& file, LiveSetUp& setup, Opening opening)
    : file_(file),
      lines_(event_bodies(setup.run.loop.session)),
      recorder_(file_, setup.run.source->format(), json_of_run(setup), opening),
      refiner_(setup.run.loop.session.refiner()) {
  setup.run.source = recorded(std::move(setup.run.source), recorder_);
}

std::optional<std::string> RunRecording::add(const Scene& scene) {
  const bool refines =
      refiner_ != nullptr && (refiner_->asked() || refiner_->taken_up() != nullptr);
  if (refines) recorder_.add_refinement(refiner_->asked(), refiner_->taken_up());
  recorder_.add_state(scene.number, state_hash(scene), lines_.line_of(scene));
  return recorder_.take_trouble();
}

LiveSummary::States RunRecording::finish() {
  counts_ = recorder_.finish();
  finished_ = true;
  trouble_ = recorder_.take_trouble().value_or("");
  lost_ = lost_of_recording(file_, counts_);
  return {counts_.states.text(), counts_.states.count()};
}

std::string RunRecording::text() const {
  std::string text;
  if (!lost_.empty()) return text;
  if (counts_.left_out > 0) {
    text = fmt::format("{} frames were left out of recording and run: the disk was behind\n",
                       counts_.left_out);
  }
  return text +
         fmt::format("{}: {} frames, {:.1f} MB, pictures of your room; palpable replay plays it\n",
                     file_.string(), counts_.frames, 1e-6 * static_cast<double>(counts_.bytes));
}

LiveChanges::LiveChanges(LiveSetUp& setup, const PlayUser& user) : setup_(setup), user_(user) {
  for (const DescribedBody& body : setup.bodies) set_at_first_.push_back(body.set);
}

void LiveChanges::begin_recording(const fs::path& file, Opening opening) {
  recording_.emplace(file, setup_, opening);
  user_.print(fmt::format("recording {}: it holds pictures of your room\n", file.string()));
}

std::optional<std::string> LiveChanges::add(const Scene& scene) {
  camera_from_body_.resize(scene.bodies.size());
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    camera_from_body_[k] = scene.bodies[k].camera_from_body;
  }
  return records() ? recording_->add(scene) : std::nullopt;
}

std::optional<LiveSummary::States> LiveChanges::end() {
  if (!records()) return std::nullopt;
  ended_with_run_ = true;
  return finish_recording();
}

LiveSummary::States LiveChanges::finish_recording() {
  LiveSummary::States states = recording_->finish();
  if (!recording_->trouble().empty()) user_.say(recording_->trouble());
  return states;
}

// The source remains wrapped and passes frames on until the next recording.
std::string LiveChanges::end_recording() {
  finish_recording();
  if (!recording_->lost().empty()) {
    user_.say(recording_->lost());
    return fmt::format("{} is lost", recording_name());
  }
  user_.print(recording_->text());
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

// Bodies with other values are read again: a body in memory is already evaluated at its values.
void LiveChanges::plan_bodies(Plan& plan) const {
  for (std::size_t k = 0; k < plan.set.size(); ++k) {
    DescribedBody body = setup_.bodies[k];
    if (plan.set[k] == body.set) continue;
    body.set = plan.set[k];
    plan.read[k] = read_live_body(body, setup_.options.contact, setup_.options.friction);
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
    if (controls.wishes.parameters) plan.set = set_of(controls, plan.set.size());
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

bool LiveChanges::apply(ScenePainter& painter, Scene& scene) {
  LiveControls& controls = painter.controls();
  if (!controls.wishes.of_frame()) return false;
  Session& session = setup_.run.loop.session;
  std::string note;
  bool begun = false;
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
    begun = true;
  } catch (const Error& error) {
    note = error.what();
    controls.placing = controls.wishes.place.has_value();
    painter.gather_parameters();
  }
  controls.wishes = {.recording = controls.wishes.recording};  // for record()
  painter.panel().note = std::move(note);
  return begun;
}

bool LiveChanges::record(ScenePainter& painter, LiveLoop& loop) {
  LiveWishes& wishes = painter.controls().wishes;
  LivePanel& panel = painter.panel();
  if (records()) panel.recording = recording_name();  // begun by --record
  if (!wishes.recording) return false;
  wishes.recording = false;
  if (records()) {
    panel.recording.clear();
    panel.note = end_recording();
    painter.refresh_panel();
    return false;
  }
  if (camera_from_body_.empty()) return false;  // no frame was processed yet: try again later
  try {
    const fs::path file = usual_recording(setup_.bodies.front().file);
    loop.begin_anew([&](LiveRun& run) { begin_recorded_session(file, run); });
    panel.note.clear();
  } catch (const Error& error) { panel.note = error.what(); }
  if (records()) panel.recording = recording_name();
  painter.begin_anew();
  painter.refresh_panel();
  return true;
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
  begin_recording(file, Opening::kNew);
}

}  // namespace palpable
