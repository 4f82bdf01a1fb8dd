#include "palpable/live/view/map_picture.h"

#include "palpable/live/render/legend.h"
#include "palpable/live/view/inset.h"
#include "palpable/live/view/room_overview.h"
#include "palpable/live/view/scene_picture.h"
#include "palpable/live/view/sensed_picture.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace palpable {
namespace {

constexpr double kFieldOfView = 0.9;  // rad, vertical
constexpr int kKeyframesEvery = 30;   // frames after which the adjusted key frames are copied again
constexpr int kDrawEvery = 3;         // frames after which the room is drawn again: 10 per second
constexpr int kMovingStep = 4;        // px of the depth between two points of moving things

constexpr Rgb kKeyframe{92, 110, 140};
constexpr Rgb kCamera{245, 140, 20};
constexpr Rgb kLost{220, 30, 30};

void add_keyframes(std::vector<MapLine>& lines, const std::vector<KeyframePose>& keyframes,
                   const PinholeCamera& camera) {
  for (const KeyframePose& keyframe : keyframes) {
    add_frustum(lines, camera, keyframe.world_from_camera, 0.03, kKeyframe, 1.0f);
  }
}

MapSurface surface_of(const MapMesh& mesh) {
  return {&mesh.vertices, &mesh.normals, &mesh.triangles, mesh.colors};
}

}  // namespace

MapPicture::MapPicture(MapRenderer renderer, const Rigid3& world_from_body)
    : renderer_(std::move(renderer)),
      view_(world_from_body.linear().col(2), world_from_body.translation().norm()),
      up_(world_from_body.linear().col(2)) {}

void MapPicture::add_moving(const Scene& scene) {
  points_.clear();
  if (scene.moving.empty()) return;
  const DepthImage& depth = scene.seen.depth;
  const int factor = scene.seen.color.width() / depth.width();
  for (int y = kMovingStep / 2; y < depth.height(); y += kMovingStep) {
    for (int x = kMovingStep / 2; x < depth.width(); x += kMovingStep) {
      const auto Z = static_cast<double>(depth(x, y));
      if (scene.moving(x, y) == 0 || !(Z > 0)) continue;
      const Rgb seen = scene.seen.color(factor * x, factor * y);
      const auto mixed = [](int a, int b) { return static_cast<std::uint8_t>((3 * a + b) / 4); };
      // Half the distance between two points.
      const double radius = 0.5 * kMovingStep * Z / scene.seen.depth_camera.fx_px;
      points_.push_back(
          {(scene.camera.world_from_camera * scene.seen.depth_camera.unproject(x, y, Z))
               .cast<float>(),
           static_cast<float>(radius),
           {mixed(seen.r, kMovingColor.r), mixed(seen.g, kMovingColor.g),
            mixed(seen.b, kMovingColor.b)}});
    }
  }
}

void MapPicture::follow(const Scene& scene) {
  ++frames_;
  path_.add(scene.camera);
  if (is_known(scene.camera)) view_.follow(scene.camera.world_from_camera, scene.time);
}

void MapPicture::draw(const Scene& scene, const Session& session, double scale, ColorScale colors,
                      const ColorImage& inside, ColorImage& picture) {
  follow(scene);
  if (session.slam().map() != nullptr) {
    if (const MapMesh* mesh = mesher_.advance(*session.slam().map())) {
      renderer_.set_surface(surface_of(*mesh));
    }
  }
  const bool known = is_known(scene.camera);
  // Not in every frame, since they are copied.
  const Tracker* tracker = session.slam().tracker();
  if (tracker != nullptr && (scene.camera.keyframe || frames_ > next_keyframes_)) {
    keyframes_ = tracker->keyframes();
    next_keyframes_ = frames_ + kKeyframesEvery - 1;
  }
  const bool due = frames_ > next_drawn_ || turned_ || known != was_known_;
  if (due) next_drawn_ = frames_ + kDrawEvery - 1;
  turned_ = false;
  was_known_ = known;
  if (due) draw_room(scene, session, scale, colors, inside.width(), inside.height());
  picture = room_;
  draw_inset(inside, picture);
  const float text_scale = legend_scale(picture.height());
  const std::array caption{caption_of(scene)};
  draw_caption(picture, caption, text_scale);
  if (const std::string warning = warning_of(scene); !warning.empty()) {
    draw_warning(picture, warning, text_scale);
  }
}

void MapPicture::draw_room(const Scene& scene, const Session& session, double scale,
                           ColorScale colors, int width, int height) {
  lines_.clear();
  path_.draw(lines_);
  const PinholeCamera& camera = scene.seen.camera;
  add_keyframes(lines_, keyframes_, camera);
  add_frustum(lines_, camera, scene.camera.world_from_camera, 0.1,
              is_known(scene.camera) ? kCamera : kLost, 2.5f);
  add_moving(scene);

  MapView view;
  view.camera = camera_of_view(width, height, kFieldOfView);
  view.camera_from_world = view_.camera_from_world();
  view.up = up_;
  view.lines = lines_;
  view.points = points_;
  looks_.clear();
  for (int k = 0; k < session.body_count(); ++k) {
    looks_.push_back(look_of_body(scene, session, k, scale, colors));
    looks_.back().camera_from_body = view.camera_from_world * session.body(k).world_from_body;
  }
  view.bodies = looks_;
  renderer_.draw(view, room_);
}

ColorImage picture_of_scan(MapRenderer& renderer, const MapMesh& surface, const CameraPath& path,
                           const std::vector<KeyframePose>& keyframes,
                           const PinholeCamera& camera) {
  renderer.set_surface(surface_of(surface));
  std::vector<MapLine> lines;
  path.draw(lines);
  add_keyframes(lines, keyframes, camera);
  MapView view;
  view.camera = camera_of_view(1280, 720, kFieldOfView);
  // If the camera was never tracked, its pose is taken to be the world's origin.
  const std::vector<Rigid3> stood{Rigid3::Identity()};
  const std::vector<Rigid3>& way = path.poses().empty() ? stood : path.poses();
  view.up = up_of_room(surface.normals, way.front());
  view.camera_from_world = overview(surface.vertices, way, view.up, view.camera);
  view.lines = lines;
  view.supersampling = 2;
  ColorImage picture;
  renderer.draw(view, picture);
  return picture;
}

}  // namespace palpable
