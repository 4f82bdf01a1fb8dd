#include "palpable/live/session/session.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/contact/contact_solver.h"
#include "palpable/common/geometry/pixel_box.h"
#include "palpable/live/session/hidden_at_start.h"
#include "palpable/live/slam/slam.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

namespace palpable {
namespace {

// px of the depth image by which the outlines of near things lie too far out, because the windows
// of our matcher reach over them: 1.0 to 1.4 px beside the measured room on six films of the
// synthetic desk; 0 to 1.0 px where colours determine the outline (kByColor); 0 beside pixels
// without depth, and none where the outline was found in the picture (kByEdge).
constexpr double kCensusFattening = 1.3;
constexpr double kByColor = 0.5;
constexpr double kByEdge = kCensusFattening;

// How far the balls of a thin thing are moved nearer, in sigmas of one pixel's depth (0.25 px). The
// middle of a finger is measured too far by 0.18 px, that of a pencil or a hand by 0.11 px: its
// outlines have larger depths, which the aggregation's paths carry inwards, and highlights on a
// curved front appear behind it (without gloss the error is half as large). With this value the
// front of a fingertip is 0.3 mm too far and its back right on six films; of two hands the front is
// 0.1 mm too near and the back 0.5 mm too thin on three. On three films with a bare desk, and on
// the demo's, whose nail reflects the lamp, the front is 1.0 mm too far (docs/lab/contact.md).
constexpr double kTooFarSigmas = 0.75;

// px by which the part of the image in which things may press is enlarged: a thing must be known
// some frames before it arrives, and its outline needs the pixels beside it.
constexpr int kBeside = 48;

// The surface settings with the noise and the outline errors of this depth camera.
ObjectSurfaceSettings fitted(ObjectSurfaceSettings surface, const DepthCamera& camera,
                             const FrameFormat& format, DepthSettings::Matcher matcher) {
  const DepthNoise& noise = camera.noise();
  surface.noise_constant = noise.constant;
  surface.noise_linear = noise.linear;
  surface.noise_quadratic = noise.quadratic;
  if (format.kind == FrameFormat::Kind::kStereo && matcher == DepthSettings::Matcher::kCensus) {
    surface.balls.fattening = kCensusFattening;
    surface.balls.too_far = kTooFarSigmas * noise.quadratic;
    surface.silhouette.beside_unknown = kCensusFattening;
    surface.silhouette.by_color = kByColor;
    surface.silhouette.by_edge = kByEdge;
  }
  return surface;
}

std::optional<Problem> wrong_setting(const SessionSettings& s) {
  if (!s.map && !s.press_static) {
    return Problem{
        "without a map it is unknown what was there when the body was anchored: all of it "
        "has to press (press_static)"};
  }
  if (!(s.surface.balls.most_radius > 0) || !(s.surface.band > 0) || s.surface.step < 1 ||
      s.surface.balls.reach < 1) {
    return Problem{fmt::format(
        "radius {} m, band {} m, step {} px and reach {} px must all be "
        "above 0",
        s.surface.balls.most_radius, s.surface.band, s.surface.step, s.surface.balls.reach)};
  }
  if (!(s.paper.press_distance > 0) || !(s.paper.press_distance < s.paper.release_distance) ||
      !std::isfinite(s.paper.release_distance)) {
    return Problem{fmt::format("delta_Incr {} m must be above 0 and below delta_Decr {} m",
                               s.paper.press_distance, s.paper.release_distance)};
  }
  if (!(s.paper.voxel > 0) || !std::isfinite(s.paper.voxel)) {
    return Problem{fmt::format("a voxel of {} m must be above 0", s.paper.voxel)};
  }
  return std::nullopt;
}

// A body with the data that the session itself keeps of it from frame to frame.
struct RememberedBody : SessionBody {
  using SessionBody::SessionBody;

  std::vector<Touch> touches;
  HiddenAtStart hidden;
  Eigen::Matrix3Xf shape;  // (3 x V) m, the shape of the last frame, where a law reads it
};

// The outlines are searched where this matcher puts them.
PressingMaskSettings fitted(PressingMaskSettings pressing, const FrameFormat& format,
                            DepthSettings::Matcher matcher) {
  if (format.kind == FrameFormat::Kind::kStereo && matcher == DepthSettings::Matcher::kCensus) {
    pressing.search.expected = -kCensusFattening;
  }
  return pressing;
}

ResponseSettings response_settings(const SessionSettings& s, const DepthCamera& camera,
                                   const FrameFormat& format) {
  return {.contact = s.contact,
          .dynamics = s.dynamics,
          .surface = fitted(s.surface, camera, format, s.depth.matcher),
          .touch = s.touch,
          .press = s.press,
          .paper = s.paper};
}

}  // namespace

struct Session::Parts {
  Parts(std::vector<PlacedBody> placed, const DepthCamera& camera, const FrameFormat& format,
        const SessionSettings& s)
      : settings(s),
        noise(camera.noise()),
        slam(camera, {.track = s.track, .map = s.map}),
        pressing(camera.noise(), fitted(settings.pressing, format, settings.depth.matcher)) {
    const ResponseSettings how = response_settings(settings, camera, format);
    for (PlacedBody& body : placed) {
      const BodyResponse* twin = twin_of(body.body);
      bodies.push_back(std::make_unique<RememberedBody>(std::move(body), how, twin));
    }
    solve_together();
    forget_room();
  }

  [[nodiscard]] const RememberedBody& body(int number) const {
    PALPABLE_EXPECT(number >= 0 && number < std::ssize(bodies), "a body of the session");
    return *bodies[static_cast<std::size_t>(number)];
  }

  [[nodiscard]] const BodyResponse* twin_of(const TouchableBody& body) const;
  void solve_together();
  void forget_room();
  void place_camera(Scene& scene, const SlamFrame& found);
  void find_hidden_parts(Scene& scene);
  void find_pressers(const Scene& scene);
  int gather_others(std::size_t of);
  [[nodiscard]] std::optional<double> take_time(double now);
  void find_touches(Scene& scene);
  void respond(Scene& scene, const SlamFrame& found);

  SessionSettings settings;
  DepthNoise noise;
  Slam slam;
  std::vector<std::unique_ptr<RememberedBody>> bodies;
  std::optional<ContactSolver> together;  // of all bodies; see solve_together()
  std::vector<ContactSolver::Near> near;  // obstacles of each body in this frame

  std::optional<AnchoredScene> anchored;
  LookedAt looked_at = LookedAt::kNothing;  // what this frame's mask was compared with
  const StaticPicture* picture = nullptr;   // the picture it was compared with
  PressingMask pressing;
  const MaskImage* shows = nullptr;  // of the last frame, in `pressing`
  SceneExtras extras;
  std::vector<Eigen::Vector3f> others;  // of gather_others()
  std::optional<double> before;         // s, of the frame before
};

// A body of the session with the same modes as this one; null: there is none.
const BodyResponse* Session::Parts::twin_of(const TouchableBody& body) const {
  if (!body.modal) return nullptr;
  for (const auto& other : bodies) {
    const ModalTables* modal = other->response.modal();
    if (modal != nullptr &&
        are_twins({&other->response.body(), modal}, {&body.body, &*body.modal})) {
      return &other->response;
    }
  }
  return nullptr;
}

// Makes the solver that several bodies share if any of them deforms; a single body whose response
// is computed in modes uses it, too. A single body with precomputed tables of touch needs none:
// TablesLaw (body_laws.h) solves its contact.
void Session::Parts::solve_together() {
  const bool any_deforms = std::any_of(bodies.begin(), bodies.end(),
                                       [](const auto& body) { return body->response.deforms(); });
  const bool is_single = bodies.size() == 1 && bodies.front()->response.modal() == nullptr;
  if (!any_deforms || is_single) return;
  std::vector<ContactSolver::Member> members;
  for (const auto& body : bodies) {
    members.push_back({&body->response.contact_body(), body->world_from_body});
  }
  together.emplace(members);
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    bodies[k]->response.join(*together, static_cast<int>(k));
  }
}

// Forgets the room: what is seen from now on is the room in which the bodies are anchored.
void Session::Parts::forget_room() {
  if (settings.map) anchored.emplace(*slam.map());
  for (const auto& body : bodies) body->hidden.begin();
}

// Copies the camera's pose and the mask of moving pixels into the scene, and places the bodies by
// that pose.
void Session::Parts::place_camera(Scene& scene, const SlamFrame& found) {
  scene.camera = found.camera;
  looked_at = found.looked_at;
  picture = found.picture;
  if (found.moving != nullptr) {
    scene.moving = *found.moving;
    scene.borrowed = *found.borrowed;
  } else {
    scene.moving.resize(0, 0);
    scene.borrowed.resize(0, 0);
  }
  if (found.camera.new_world) forget_room();
  if (!found.corrections.empty()) {
    const StageTimer timer(scene.times, "map");
    anchored->follow(found.corrections);
  }
  if (found.fused) {
    const StageTimer timer(scene.times, "map");
    anchored->update(*slam.map(), *slam.space(), found.camera.newest_keyframe);
  }
  // If the camera has not moved, the pose is the given one to the bit.
  const bool stands = scene.camera.world_from_camera.matrix().isIdentity(0);
  const Rigid3 camera_from_world = scene.camera.world_from_camera.inverse();
  scene.bodies.resize(bodies.size());
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const Rigid3& place = bodies[k]->world_from_body;
    scene.bodies[k].camera_from_body = stands ? place : camera_from_world * place;
  }
}

// Finds the parts of bodies that have been hidden since the start. A thing there was there before,
// so it counts as the room and does not press.
void Session::Parts::find_hidden_parts(Scene& scene) {
  if (settings.press_static || scene.camera.state == TrackState::kLost) return;
  const SeenFrame& seen = scene.seen;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    RememberedBody& body = *bodies[k];
    scene.bodies[k].hidden_since_start =
        body.hidden.look(seen.depth, seen.depth_camera, noise,
                         body.response.body().surface.vertices, scene.bodies[k].camera_from_body);
  }
}

// Finds what each pixel near the bodies shows. Nothing presses while the camera is lost, because
// the obstacles' positions in the world are not known.
void Session::Parts::find_pressers(const Scene& scene) {
  const SeenFrame& seen = scene.seen;
  PixelBox box;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    box = united(box, bodies[k]->response.box_of_interest(scene.bodies[k].camera_from_body,
                                                          seen.depth_camera));
  }
  box = grown(box, kBeside, seen.depth_camera);
  const bool lost = scene.camera.state == TrackState::kLost;
  if (settings.press_static && !lost) {
    shows = &pressing.find_all(seen, box);
    return;
  }
  if (lost || scene.moving.empty()) {
    shows = &pressing.find_nothing(seen, box);
    return;
  }
  shows = &pressing.find(seen, scene.camera.world_from_camera, scene.moving, looked_at, *anchored,
                         *slam.space(), box, picture);
}

// Gathers the skin of another body that something real pressed in the frame before, in the frame of
// body `of`. Algorithm 1 as printed takes it as an obstacle of the lower beam. @return its number,
// -1: there is none
int Session::Parts::gather_others(std::size_t of) {
  others.clear();
  if (!bodies[of]->response.reads_others()) return -1;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const RememberedBody& other = *bodies[k];
    const bool pressed = !other.touches.empty() && other.touches.front().by < 0;
    if (k == of || !pressed) continue;
    const Eigen::Isometry3f to_body =
        (bodies[of]->world_from_body.inverse() * other.world_from_body).cast<float>();
    for (Eigen::Index v = 0; v < other.shape.cols(); ++v) {
      others.emplace_back(to_body * Eigen::Vector3f(other.shape.col(v)));
    }
    return static_cast<int>(k);
  }
  return -1;
}

// s since the frame before; nothing without inertia.
std::optional<double> Session::Parts::take_time(double now) {
  const double passed = before ? std::max(0.0, now - *before) : 0.0;
  before = now;
  return settings.dynamics ? std::optional(passed) : std::nullopt;
}

// Finds the touches of all bodies, the strongest first; of equal ones that of the lower body
// number.
void Session::Parts::find_touches(Scene& scene) {
  scene.touches.clear();
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    bodies[k]->response.look(scene.seen, *shows, pressing.coverage(),
                             scene.bodies[k].camera_from_body);
  }
  scene.mutual_penetration = scene.imbalance = scene.left_to_move = scene.inside = 0;
  scene.friction_residual = scene.ringing = 0;
  const std::optional<double> passed = take_time(scene.time);
  scene.contacts_dropped = 0;
  if (together) {
    near.clear();
    for (const auto& body : bodies) near.push_back(body->response.near());
    const ContactReport report = together->advance(near, passed);
    scene.mutual_penetration = report.mutual_penetration;
    scene.imbalance = report.imbalance;
    scene.left_to_move = report.unsolved();
    scene.inside = report.inside();
    scene.contacts_dropped = report.dropped;
    scene.friction_residual = report.friction_residual;
    scene.ringing = report.ringing;
  }
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    RememberedBody& body = *bodies[k];
    const int by = gather_others(k);
    body.response.find_touches({scene.time, passed}, others, by, body.touches);
    int dropped = 0;
    if (!together) {
      const ContactReport report = body.response.report();
      scene.left_to_move = std::max(scene.left_to_move, report.unsolved());
      scene.inside = std::max(scene.inside, report.inside());
      dropped = report.dropped;
      scene.contacts_dropped += dropped;
      scene.friction_residual = std::max(scene.friction_residual, report.friction_residual);
      scene.ringing += report.ringing;
    } else {
      dropped = together->report_of(static_cast<int>(k)).dropped;
    }
    for (Touch& touch : body.touches) {
      touch.body = static_cast<int>(k);
      touch.left_out = dropped;
      if (touch.by >= 0) {
        touch.coefficient =
            friction_between(body.response.coefficient(),
                             bodies[static_cast<std::size_t>(touch.by)]->response.coefficient());
      }
      scene.touches.push_back(touch);
    }
  }
  if (bodies.size() > 1) sort_by_force(scene.touches);
}

Session::Session(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Session::Session(Session&&) noexcept = default;
Session& Session::operator=(Session&&) noexcept = default;
Session::~Session() = default;

Result<Session> Session::make(std::vector<PlacedBody> bodies, const DepthCamera& camera,
                              const FrameFormat& format, const SessionSettings& settings) {
  if (bodies.empty()) return Problem{"a session has a body"};
  if (auto problem = wrong_setting(settings)) return *problem;
  return Session(std::make_unique<Parts>(std::move(bodies), camera, format, settings));
}

void Session::Parts::respond(Scene& scene, const SlamFrame& found) {
  scene.number = scene.seen.number;
  scene.time = scene.seen.time;

  place_camera(scene, found);
  {
    const StageTimer timer(scene.times, "presses");
    find_hidden_parts(scene);
    find_pressers(scene);
  }
  {
    const StageTimer timer(scene.times, "contact");
    find_touches(scene);
  }
  const StageTimer timer(scene.times, "evaluate");
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    RememberedBody& body = *bodies[k];
    body.response.reconstruct(body.touches, extras, scene.bodies[k]);
    if (body.response.reads_others() && bodies.size() > 1) body.shape = scene.bodies[k].vertices;
    body.response.move_obstacle(scene.bodies[k].vertices);
  }
}

void Session::respond(Scene& scene) {
  parts_->respond(scene, parts_->slam.advance(scene.seen, scene.times));
}

void Session::respond(Scene& scene, const std::optional<Rigid3>& world_from_camera) {
  PALPABLE_EXPECT(!parts_->settings.track, "a session that follows the camera finds its own poses");
  parts_->respond(scene, parts_->slam.advance(scene.seen, world_from_camera, scene.times));
}

void Session::keep(const SceneExtras& extras) { parts_->extras = extras; }
const SceneExtras& Session::kept() const { return parts_->extras; }

void Session::refine_with(Refiner refiner) {
  parts_->bodies.front()->response.refine_with(std::move(refiner));
}
Refiner* Session::refiner() { return parts_->bodies.front()->response.refiner(); }
const Refiner* Session::refiner() const { return parts_->body(0).response.refiner(); }

std::vector<PlacedBody> Session::take_bodies() {
  std::vector<PlacedBody> taken;
  for (const auto& body : parts_->bodies) {
    taken.push_back({body->response.take_body(), body->world_from_body, body->name, body->color});
  }
  return taken;
}

int Session::body_count() const { return static_cast<int>(parts_->bodies.size()); }
const SessionBody& Session::body(int number) const { return parts_->body(number); }
const MaskImage& Session::shows() const {
  PALPABLE_EXPECT(parts_->shows != nullptr, "a frame was processed");
  return *parts_->shows;
}
const Image<float>* Session::coverage() const { return parts_->pressing.coverage(); }
const Slam& Session::slam() const { return parts_->slam; }
const AnchoredScene* Session::anchored_scene() const {
  return parts_->anchored ? &*parts_->anchored : nullptr;
}
const SessionSettings& Session::settings() const { return parts_->settings; }

}  // namespace palpable
