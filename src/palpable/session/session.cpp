#include "palpable/session/session.h"

#include "palpable/base/contract.h"
#include "palpable/geometry/pixel_box.h"
#include "palpable/reduced/pressed_surface.h"
#include "palpable/slam/slam.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <utility>

namespace palpable {
namespace {

// The windows of our matcher reach over the outlines of near things, by two pixels of the picture,
// which are one of the depth. With 0, 0.5, 0.8 and 1.1 px the unseen side of a finger was off by
// 1.9, 1.1, 0.6 and 0.46 mm (`palpable bench surface --only press --seed 1`, median).
constexpr double kCensusFattening = 1.1;

// px around the part of the image in which things may press: a thing is known some frames before it
// arrives, and its outlines need what lies beside.
constexpr int kBeside = 48;

// What the camera knows of its depths.
ObjectSurfaceSettings fitted(ObjectSurfaceSettings surface, const DepthCamera& camera,
                             const FrameFormat& format, DepthSettings::Matcher matcher) {
  const DepthNoise& noise = camera.noise();
  surface.noise_constant = noise.constant;
  surface.noise_linear = noise.linear;
  surface.noise_quadratic = noise.quadratic;
  if (format.kind == FrameFormat::Kind::kStereo && matcher == DepthSettings::Matcher::kCensus) {
    surface.balls.fattening = kCensusFattening;
  }
  return surface;
}

std::optional<Problem> wrong_setting(const SessionSettings& s) {
  if (!s.map && !s.press_static) {
    return Problem{
        "without a map nobody knows what was there when the body was anchored: all of it "
        "has to press (press_static)"};
  }
  if (!(s.surface.balls.most_radius > 0) || !(s.surface.band > 0) || s.surface.step < 1 ||
      s.surface.balls.reach < 1) {
    return Problem{fmt::format(
        "radius {} m, band {} m, step {} px and reach {} px must all be "
        "above 0",
        s.surface.balls.most_radius, s.surface.band, s.surface.step, s.surface.balls.reach)};
  }
  if (!(s.paper.press_distance > 0) || !(s.paper.press_distance < s.paper.release_distance)) {
    return Problem{fmt::format("delta_Incr {} m must be above 0 and below delta_Decr {} m",
                               s.paper.press_distance, s.paper.release_distance)};
  }
  return std::nullopt;
}

}  // namespace

std::string_view name_of(ContactKind kind) {
  switch (kind) {
    case ContactKind::kAnywhere:
      return "anywhere";
    case ContactKind::kSite:
      return "site";
    case ContactKind::kPaper:
      break;
  }
  return "paper";
}

struct Session::Parts {
  Parts(TouchableBody b, const Rigid3& pose, const DepthCamera& camera, const FrameFormat& format,
        const SessionSettings& s)
      : body(std::move(b.body)),
        tables(std::move(b.touch)),
        world_from_body(pose),
        settings(s),
        slam(camera, {.track = s.track, .map = s.map}),
        rest(body.surface.vertices.cast<float>()),
        at_rest(static_cast<std::size_t>(rest.cols()), 0.0f),
        region(box_of(body.surface)),
        pressing(camera.noise(), settings.pressing),
        surface(fitted(settings.surface, camera, format, settings.depth.matcher)) {
    if (tables && s.contact == ContactKind::kAnywhere) {
      anywhere.emplace(body.surface, body.fixed, *tables, settings.touch);
      anywhere->stress(touched, at_rest);
    } else if (s.contact != ContactKind::kPaper) {
      law.emplace(body, settings.press);
    }
    forget_room();
  }

  void forget_room();
  void follow_camera(Scene& scene);
  void find_what_presses(const Scene& scene);
  void find_touches(Scene& scene);
  void reconstruct(Scene& scene);

  ReducedBody body;
  std::optional<TouchTables> tables;
  Rigid3 world_from_body;
  SessionSettings settings;
  Slam slam;
  Eigen::Matrix3Xf rest;       // (3 x V) m
  std::vector<float> at_rest;  // (V) Pa, von Mises stress where nothing touches
  Eigen::AlignedBox3d region;

  std::optional<AnchoredScene> anchored;
  LookedAt looked_at = LookedAt::kNothing;  // with what the mask of this frame was compared
  const StaticPicture* picture = nullptr;   // that one
  PressingMask pressing;
  const MaskImage* shows = nullptr;  // of the pressing mask
  ObjectSurface surface;
  std::optional<SkinContact> anywhere;
  std::optional<Refiner> refiner;
  TouchState touched;
  std::optional<PressLaw> law;
  PressState press;
  PaperState paper;
  Eigen::Matrix3Xf nodes;
};

// Forgets what was learnt of the room: what is seen from now on is the room in which the body
// stands.
void Session::Parts::forget_room() {
  if (settings.map) anchored.emplace(*slam.map());
}

// Finds out where the camera is, and with it the body, and what moves.
void Session::Parts::follow_camera(Scene& scene) {
  const SlamFrame& found = slam.advance(scene.seen, scene.times);
  scene.camera = found.camera;
  looked_at = found.looked_at;
  picture = found.picture;
  if (found.moving != nullptr) {
    scene.moving = *found.moving;
  } else {
    scene.moving.resize(0, 0);
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
  // A camera that has not moved sees the body where it was put, to the bit.
  scene.camera_from_body = scene.camera.world_from_camera.matrix().isIdentity(0)
                               ? world_from_body
                               : scene.camera.world_from_camera.inverse() * world_from_body;
}

// What each pixel near the body shows. A camera that is lost knows nothing of it: where the hand is
// in the world is not known.
void Session::Parts::find_what_presses(const Scene& scene) {
  const SeenFrame& seen = scene.seen;
  const PixelBox box =
      grown(surface.box_of_interest(region, scene.camera_from_body, seen.depth_camera), kBeside,
            seen.depth_camera);
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

void Session::Parts::find_touches(Scene& scene) {
  std::vector<Touch>& touches = scene.touches;
  touches.clear();
  scene.stated_error.reset();
  if (anywhere) {
    if (refiner) refiner->begin_frame(anywhere->solver(), touched);
    const TouchReport report = anywhere->advance(touched, surface, touches);
    if (refiner) refiner->end_frame(anywhere->solver(), touched, report);
    scene.stated_error = report.stated;
    return;
  }
  if (law) {
    press = law->advance(press, surface, scene.time);
    if (press.touch) touches.push_back(*press.touch);
    return;
  }
  deformed_nodes(paper, body, nodes);
  const int last = static_cast<int>(body.levels().size()) - 1;
  paper = advance_as_printed(paper, nearest_node(nodes, surface.cloud()), last, settings.paper);
  if (const auto touch = touch_of(paper, body)) touches.push_back(*touch);
}

void Session::Parts::reconstruct(Scene& scene) {
  scene.vertices.resize(3, rest.cols());
  scene.normals.resize(3, rest.cols());
  scene.von_mises.resize(static_cast<std::size_t>(rest.cols()));
  if (scene.touches.empty()) {
    scene.vertices = rest;
    vertex_normals(scene.vertices, body.surface.triangles, scene.normals);
    std::copy(at_rest.begin(), at_rest.end(), scene.von_mises.begin());
  } else if (anywhere) {
    anywhere->place(touched, scene.vertices);
    vertex_normals(scene.vertices, body.surface.triangles, scene.normals);
    anywhere->stress(touched, scene.von_mises);
  } else {
    const Touch& touch = scene.touches.front();
    const std::array mu{static_cast<double>(touch.site), touch.level};
    press_surface(body, rest, mu, scene.vertices, scene.normals, scene.von_mises);
  }
}

Session::Session(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Session::Session(Session&&) noexcept = default;
Session& Session::operator=(Session&&) noexcept = default;
Session::~Session() = default;

Result<Session> Session::make(TouchableBody body, const Rigid3& world_from_body,
                              const DepthCamera& camera, const FrameFormat& format,
                              const SessionSettings& settings) {
  if (auto problem = wrong_setting(settings)) return *problem;
  return Session(
      std::make_unique<Parts>(std::move(body), world_from_body, camera, format, settings));
}

void Session::respond(Scene& scene) {
  Parts& p = *parts_;
  const SeenFrame& seen = scene.seen;
  scene.number = seen.number;
  scene.time = seen.time;

  p.follow_camera(scene);
  {
    const StageTimer timer(scene.times, "presses");
    p.find_what_presses(scene);
  }
  {
    const StageTimer timer(scene.times, "contact");
    p.surface.build(seen.depth, *p.shows, seen.depth_camera, scene.camera_from_body.inverse(),
                    p.region, seen.time);
    p.find_touches(scene);
  }
  const StageTimer timer(scene.times, "evaluate");
  p.reconstruct(scene);
}

void Session::refine_with(Refiner refiner) { parts_->refiner.emplace(std::move(refiner)); }
Refiner* Session::refiner() { return parts_->refiner ? &*parts_->refiner : nullptr; }
const Refiner* Session::refiner() const { return parts_->refiner ? &*parts_->refiner : nullptr; }

ContactKind Session::contact() const {
  const ContactKind wanted = parts_->settings.contact;
  return wanted == ContactKind::kAnywhere && !parts_->anywhere ? ContactKind::kSite : wanted;
}
const MaskImage& Session::shows() const {
  PALPABLE_EXPECT(parts_->shows != nullptr, "a frame was answered");
  return *parts_->shows;
}
const ObjectSurface& Session::surface() const { return parts_->surface; }
const SurfaceMap* Session::map() const { return parts_->slam.map(); }
const FreeSpace* Session::free_space() const { return parts_->slam.space(); }
const AnchoredScene* Session::anchored_scene() const {
  return parts_->anchored ? &*parts_->anchored : nullptr;
}
const ReducedBody& Session::body() const { return parts_->body; }
const Rigid3& Session::world_from_body() const { return parts_->world_from_body; }
TrackerCounts Session::tracker_counts() const {
  const Tracker* tracker = parts_->slam.tracker();
  return tracker != nullptr ? tracker->counts() : TrackerCounts{};
}
std::vector<KeyframePose> Session::keyframes() const {
  const Tracker* tracker = parts_->slam.tracker();
  return tracker != nullptr ? tracker->keyframes() : std::vector<KeyframePose>{};
}
const SessionSettings& Session::settings() const { return parts_->settings; }

}  // namespace palpable
