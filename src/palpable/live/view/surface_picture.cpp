#include "palpable/live/view/surface_picture.h"

#include "palpable/live/render/legend.h"
#include "palpable/live/view/inset.h"
#include "palpable/live/view/room_frame.h"
#include "palpable/live/view/scene_picture.h"

#include <fmt/core.h>

#include <array>
#include <string>
#include <utility>

namespace palpable {
namespace {

constexpr double kSurfaceFieldOfView = 0.7;  // rad, vertical
constexpr double kSurfaceElevation = 0.5;    // rad above the floor
constexpr double kAround = 0.06;             // m around the body in which seen points are drawn
constexpr int kPointStep = 2;                // px of the depth between two points

constexpr Rgb kMeasured{60, 160, 110};
constexpr Rgb kAssumed{240, 150, 50};
constexpr Rgb kHeld{150, 150, 155};

}  // namespace

void mesh_balls(std::span<const ObjectBall> balls, const Eigen::Vector3f& camera_in_body,
                BallMesh& mesh) {
  static const SurfaceMesh sphere = sphere_surface(Eigen::Vector3d::Zero(), 1, 2);
  static const Eigen::Matrix3Xf unit = sphere.vertices.cast<float>();
  const Eigen::Index N = unit.cols(), M = sphere.triangles.cols();
  const Eigen::Index count = std::ssize(balls);
  mesh.vertices.resize(3, count * N);
  mesh.normals.resize(3, count * N);
  mesh.triangles.resize(3, count * M);
  mesh.colors.resize(static_cast<std::size_t>(count * N));
  for (Eigen::Index k = 0; k < count; ++k) {
    const ObjectBall& ball = balls[static_cast<std::size_t>(k)];
    mesh.vertices.middleCols(k * N, N) = (ball.radius * unit).colwise() + ball.centre;
    mesh.normals.middleCols(k * N, N) = unit;
    mesh.triangles.middleCols(k * M, M) =
        (sphere.triangles.array() + static_cast<int>(k * N)).matrix();
    const Eigen::Vector3f to_camera = camera_in_body - ball.centre;
    for (Eigen::Index i = 0; i < N; ++i) {
      mesh.colors[static_cast<std::size_t>(k * N + i)] = ball.unseen_for > 0 ? kHeld
                                                         : unit.col(i).dot(to_camera) > ball.radius
                                                             ? kMeasured
                                                             : kAssumed;
    }
  }
}

SurfacePicture::SurfacePicture(MapRenderer renderer, const Session& session)
    : renderer_(std::move(renderer)) {
  Eigen::AlignedBox3d box;
  for (int k = 0; k < session.body_count(); ++k) {
    const Rigid3 first_from_body =
        session.body().world_from_body.inverse() * session.body(k).world_from_body;
    box.extend(box_of(session.body(k).model().surface).transformed(first_from_body));
  }
  const Eigen::Vector3d around = Eigen::Vector3d::Constant(kAround);
  near_ = {box.min() - around, box.max() + around};
  usual_.target = box.center();
  usual_.elevation = kSurfaceElevation;
  usual_.distance = 2.2 * box.diagonal().norm();
  orbit_ = usual_;
}

void SurfacePicture::handle(const WindowEvent& event) {
  if (const auto way = drag_.follow(event)) orbit_.turn(way->x_px, way->y_px);
  if (event.kind == WindowEvent::Kind::kWheel) orbit_.zoom(event.wheel, usual_.distance);
  if (event.kind == WindowEvent::Kind::kKey && event.key == 'R') orbit_ = usual_;
}

void SurfacePicture::add_points(const Scene& scene) {
  points_.clear();
  const Rigid3 body_from_camera = scene.bodies.front().camera_from_body.inverse();
  const DepthImage& depth = scene.seen.depth;
  const int factor = scene.seen.color.width() / depth.width();
  for (int y = 0; y < depth.height(); y += kPointStep) {
    for (int x = 0; x < depth.width(); x += kPointStep) {
      const auto Z = static_cast<double>(depth(x, y));
      if (!(Z > 0)) continue;
      const Eigen::Vector3d at = body_from_camera * scene.seen.depth_camera.unproject(x, y, Z);
      if (!near_.contains(at)) continue;
      const double radius = 0.35 * kPointStep * Z / scene.seen.depth_camera.fx_px;
      points_.push_back(
          {at.cast<float>(), static_cast<float>(radius), scene.seen.color(factor * x, factor * y)});
    }
  }
}

// Gathers the balls of all bodies. A ball near two bodies is drawn twice in the same position.
void SurfacePicture::gather_balls(const Session& session) {
  balls_.clear();
  for (int k = 0; k < session.body_count(); ++k) {
    const Eigen::Isometry3f first_from_body =
        (session.body().world_from_body.inverse() * session.body(k).world_from_body).cast<float>();
    for (ObjectBall ball : session.body(k).response.surface().balls()) {
      if (k > 0) ball.centre = first_from_body * ball.centre;
      balls_.push_back(ball);
    }
  }
}

void SurfacePicture::draw(const Scene& scene, const Session& session, double scale,
                          ColorScale colors, const ColorImage& inside, ColorImage& picture) {
  const Rigid3 body_from_camera = scene.bodies.front().camera_from_body.inverse();
  if (!placed_) {
    usual_.azimuth = heading_of(body_from_camera) + 2 * kOverTheShoulder;
    orbit_ = usual_;
    placed_ = true;
  }
  gather_balls(session);
  mesh_balls(balls_, body_from_camera.translation().cast<float>(), mesh_);
  renderer_.set_surface({&mesh_.vertices, &mesh_.normals, &mesh_.triangles, mesh_.colors});
  add_points(scene);
  MapView view;
  view.camera = camera_of_view(inside.width(), inside.height(), kSurfaceFieldOfView);
  view.camera_from_world = orbit_.camera_from_body();
  view.up = Eigen::Vector3d::UnitZ();
  view.points = points_;
  looks_.clear();
  for (int k = 0; k < session.body_count(); ++k) {
    const SceneBody& shown = scene.bodies[static_cast<std::size_t>(k)];
    looks_.push_back(look_of_body(scene, session, k, scale, colors));
    looks_.back().camera_from_body =
        view.camera_from_world * (body_from_camera * shown.camera_from_body);
  }
  view.bodies = looks_;
  renderer_.draw(view, picture);
  draw_inset(inside, picture);
  const float text_scale = legend_scale(picture.height());
  const std::array<std::string, 2> caption{
      caption_of(scene),
      fmt::format("{} balls: green seen, orange assumed, grey held", balls_.size())};
  draw_caption(picture, caption, text_scale);
  if (const std::string warning = warning_of(scene); !warning.empty()) {
    draw_warning(picture, warning, text_scale);
  }
}

}  // namespace palpable
