#include "palpable/session/session.h"

#include "palpable/base/contract.h"
#include "palpable/depth/depth_edges.h"
#include "palpable/depth/static_background.h"
#include "palpable/reduced/pressed_surface.h"
#include "palpable/slam/slam.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <utility>

namespace palpable {
namespace {

// Depths of neighbours that differ by more than this share belong to different things. A desk seen
// at 80 degrees changes by 1.6 % per pixel (depth_edges.h).
constexpr double kJumpShare = 0.06;

// The thickness behind a seen surface is at least so many sigma of its depth.
constexpr double kThicknessInSigmas = 3;
constexpr double kPointsPerThickness = 4;

// Left of a hand there is a strip that the left eye alone sees. A stereo matcher gives part of it
// the hand's depth, wrongly: points there would press. So points that near to a left outline are
// dropped; this is the width in px at half resolution. Too narrow: thin air presses. Too wide:
// nothing is left of a finger (with 12 px of a finger's 13 gone, two of three touches of the demo
// were not felt).
//
// OpenCV's matcher: of 100 wrong pixels 96 lay within 5 px, with holes beside them.
// Ours leaves most of the strip unknown. On two demo clips (medians):
//
//     margin   penetration left   of 100 touches felt were true
//     3 px     1.3 and 0.8 mm     93 and 100
//     4 px     1.7 and 0.9 mm     95 and 100; two touching frames fewer
constexpr int kCensusLeftMargin = 3;
constexpr int kOpenCvLeftMargin = 12;

Eigen::AlignedBox3d box_of(const SurfaceMesh& surface) {
  return {surface.vertices.rowwise().minCoeff(), surface.vertices.rowwise().maxCoeff()};
}

PressSettings with_noise(PressSettings press, const DepthNoise& noise, double share) {
  press.noise_constant = share * noise.constant;
  press.noise_linear = share * noise.linear;
  press.noise_quadratic = share * noise.quadratic;
  return press;
}

// Fits the seen surface to the distance at which the body stands. Far away the depth is uncertain
// by half a finger: in an object as thick as a finger nothing would be deep enough inside to count,
// so the thickness grows. And pixels lie farther apart: with the same step too few points would say
// that a vertex is inside.
SeenSurfaceSettings fitted(SeenSurfaceSettings surface, const DepthCamera& camera,
                           const FrameFormat& format, DepthSettings::Matcher matcher,
                           const Rigid3& world_from_body) {
  if (format.kind == FrameFormat::Kind::kStereo) {
    surface.left_margin = std::max(surface.left_margin, matcher == DepthSettings::Matcher::kCensus
                                                            ? kCensusLeftMargin
                                                            : kOpenCvLeftMargin);
  }
  const double Z = std::max(world_from_body.translation().z(), 0.0);  // from the first camera
  surface.thickness = std::max(surface.thickness, kThicknessInSigmas * camera.noise().sigma(Z));
  const double spacing = Z / camera.depth_camera().fx_px;  // of neighbouring pixels
  const double step = std::floor(surface.thickness / (kPointsPerThickness * spacing));
  surface.step = static_cast<int>(std::clamp(step, 1.0, static_cast<double>(surface.step)));
  return surface;
}

std::optional<Problem> wrong_setting(const SessionSettings& s) {
  if (s.ignore_static && (s.static_frames < 1 || s.static_frames > 255)) {
    return Problem{
        fmt::format("{} frames to learn what is static: 1 to 255 are possible", s.static_frames)};
  }
  if (!(s.surface.thickness > 0) || !(s.surface.band > 0) || s.surface.step < 1 ||
      s.surface.normal_reach < 1) {
    return Problem{
        fmt::format("thickness {} m, band {} m, step {} px and reach {} px must all be above 0",
                    s.surface.thickness, s.surface.band, s.surface.step, s.surface.normal_reach)};
  }
  if (!(s.paper.press_distance > 0) || !(s.paper.press_distance < s.paper.release_distance)) {
    return Problem{fmt::format("delta_Incr {} m must be above 0 and below delta_Decr {} m",
                               s.paper.press_distance, s.paper.release_distance)};
  }
  if (!(s.noise_share >= 0)) {
    return Problem{fmt::format("a noise share of {} is negative", s.noise_share)};
  }
  return std::nullopt;
}

}  // namespace

struct Session::Parts {
  Parts(ReducedBody b, const Rigid3& pose, const DepthCamera& camera, const FrameFormat& format,
        const SessionSettings& s)
      : body(std::move(b)),
        world_from_body(pose),
        settings(s),
        noise(camera.noise()),
        slam(camera, {.track = s.track, .map = s.map}),
        rest(body.surface.vertices.cast<float>()),
        region(box_of(body.surface)),
        surface(fitted(settings.surface, camera, format, settings.depth.matcher, pose)),
        law(body, with_noise(settings.press, noise, settings.noise_share)) {
    forget_room();
  }

  void forget_room();
  void follow_camera(Scene& scene);
  bool find_contact_depth(const SeenFrame& seen, const TrackedPose& tracked);
  std::optional<Touch> touch_of_frame(double time);
  void reconstruct(Scene& scene);

  ReducedBody body;
  Rigid3 world_from_body;
  SessionSettings settings;
  DepthNoise noise;
  Slam slam;
  Eigen::Matrix3Xf rest;  // (3 x V) m
  Eigen::AlignedBox3d region;

  std::optional<AnchoredScene> anchored;
  std::optional<StaticBackground> background;
  Rigid3 learnt_from_world = Rigid3::Identity();  // the camera when the background was learnt
  DepthImage contact_depth;  // what may press; the scene's depth keeps everything, for drawing
  MaskImage scratch;
  SeenSurface surface;
  PressLaw law;
  PressState press;
  PaperState paper;
  Eigen::Matrix3Xf nodes;
};

// Forgets what was learnt of the room: what is seen from now on is the room in which the body
// stands.
void Session::Parts::forget_room() {
  if (settings.map) anchored.emplace(*slam.map());
  if (settings.ignore_static) {
    background.emplace(noise, StaticBackgroundSettings{.frames = settings.static_frames});
  }
}

// Finds out where the camera is, and with it the body, and what moves.
void Session::Parts::follow_camera(Scene& scene) {
  const SlamFrame& found = slam.advance(scene.seen, scene.times);
  scene.camera = found.camera;
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

// What may press in this frame; false while the background is being learnt.
bool Session::Parts::find_contact_depth(const SeenFrame& seen, const TrackedPose& tracked) {
  contact_depth.resize(seen.depth.width(), seen.depth.height());
  if (tracked.state == TrackState::kLost) {  // where the hand is in the world is not known
    std::fill(contact_depth.begin(), contact_depth.end(), std::numeric_limits<float>::quiet_NaN());
    return !background || background->ready();
  }
  const Rigid3 camera_from_world = tracked.world_from_camera.inverse();
  std::copy(seen.depth.begin(), seen.depth.end(), contact_depth.begin());
  if (background && !background->ready()) {
    background->learn(contact_depth);
    learnt_from_world = camera_from_world;
    std::fill(contact_depth.begin(), contact_depth.end(), std::numeric_limits<float>::quiet_NaN());
    return false;
  }
  forget_jumps(contact_depth, kJumpShare, scratch);
  if (!background) return true;
  const Rigid3 now_from_learnt = camera_from_world * learnt_from_world.inverse();
  if (now_from_learnt.matrix().isIdentity(1e-12)) {
    background->remove_static(contact_depth);
  } else {
    background->remove_static(contact_depth, seen.depth_camera, now_from_learnt);
  }
  return true;
}

std::optional<Touch> Session::Parts::touch_of_frame(double time) {
  if (settings.contact == ContactKind::kPress) {
    press = law.advance(press, surface, time);
    return press.touch;
  }
  deformed_nodes(paper, body, nodes);
  const int last = static_cast<int>(body.levels().size()) - 1;
  paper = advance_as_printed(paper, nearest_node(nodes, surface.points()), last, settings.paper);
  return touch_of(paper, body);
}

void Session::Parts::reconstruct(Scene& scene) {
  scene.vertices.resize(3, rest.cols());
  scene.normals.resize(3, rest.cols());
  scene.von_mises.resize(static_cast<std::size_t>(rest.cols()));
  if (scene.touches.empty()) {
    scene.vertices = rest;
    vertex_normals(scene.vertices, body.surface.triangles, scene.normals);
    std::fill(scene.von_mises.begin(), scene.von_mises.end(), 0.0f);
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

Result<Session> Session::make(ReducedBody body, const Rigid3& world_from_body,
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
  scene.touches.clear();
  scene.touches.reserve(1);

  p.follow_camera(scene);
  bool may_press = false;
  {
    const StageTimer timer(scene.times, "background");
    may_press = p.find_contact_depth(seen, scene.camera);
  }
  if (may_press) {
    const StageTimer timer(scene.times, "contact");
    p.surface.build(p.contact_depth, seen.depth_camera, scene.camera_from_body.inverse(), p.region);
    if (const auto touch = p.touch_of_frame(seen.time)) scene.touches.push_back(*touch);
  }
  const StageTimer timer(scene.times, "evaluate");
  p.reconstruct(scene);
}

const DepthImage& Session::pressing_depth() const { return parts_->contact_depth; }
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
