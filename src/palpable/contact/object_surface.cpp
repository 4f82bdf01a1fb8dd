#include "palpable/contact/object_surface.h"

#include "palpable/base/contract.h"

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using Eigen::Vector3f;

bool is_depth(float z) { return std::isfinite(z) && z > 0.0f; }

// The part of the image in which a box of space may be seen; empty when it is not.
PixelBox box_in_image(const AlignedBox3d& in_body, const Rigid3& camera_from_body,
                      const PinholeCamera& camera) {
  Eigen::AlignedBox2d seen;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3d x =
        camera_from_body * in_body.corner(static_cast<AlignedBox3d::CornerType>(corner));
    // The camera stands beside or in the box: anything may be seen.
    if (x.z() < 1e-3) return {0, 0, camera.width, camera.height};
    seen.extend(Eigen::Vector2d(camera.cx_px + camera.fx_px * x.x() / x.z(),
                                camera.cy_px + camera.fy_px * x.y() / x.z()));
  }
  const auto pixel = [](double p, int count) {
    return static_cast<int>(std::clamp(std::floor(p), 0.0, static_cast<double>(count)));
  };
  const int left = pixel(seen.min().x(), camera.width), top = pixel(seen.min().y(), camera.height);
  const int right = pixel(seen.max().x() + 1, camera.width);
  const int bottom = pixel(seen.max().y() + 1, camera.height);
  return {left, top, right - left, bottom - top};
}

}  // namespace

ObjectSurface::ObjectSurface(const ObjectSurfaceSettings& settings)
    : settings_(settings), silhouette_(settings.silhouette) {
  PALPABLE_EXPECT(settings.step >= 1, "every pixel is the finest decimation");
  PALPABLE_EXPECT(settings.balls.reach >= 1, "a normal needs neighbours");
  PALPABLE_EXPECT(settings.balls.most_radius > 0 && settings.band > 0 &&
                      settings.silhouette.largest_jump_at_1m > 0,
                  "radius, band and jump are lengths above 0");
}

void ObjectSurface::start(const AlignedBox3d& region_in_body, const Vector3f& camera_in_body) {
  PALPABLE_EXPECT(!region_in_body.isEmpty(), "the region around a body is not empty");
  const Vector3f band = Vector3f::Constant(static_cast<float>(settings_.band));
  region_ = Eigen::AlignedBox3f(region_in_body.min().cast<float>() - band,
                                region_in_body.max().cast<float>() + band);
  camera_ = camera_in_body;
  balls_.clear();
  cloud_.clear();
}

// A ball matters to a query in the region when it reaches into the query's band.
void ObjectSurface::keep(const ObjectBall& ball) {
  if (region_.squaredExteriorDistance(ball.centre) < ball.radius * ball.radius) {
    balls_.push_back(ball);
  }
}

void ObjectSurface::finish() {
  bare_.clear();
  for (const ObjectBall& ball : balls_) bare_.push_back({ball.centre, ball.radius});
  tree_.build(bare_);
}

void ObjectSurface::build(const DepthImage& depth, const MaskImage& presses,
                          const PinholeCamera& camera, const Rigid3& body_from_camera,
                          const AlignedBox3d& region_in_body) {
  PALPABLE_EXPECT(depth.width() == camera.width && depth.height() == camera.height,
                  "the camera is the depth image's own");
  start(region_in_body, body_from_camera.translation().cast<float>());
  // The front of a ball that matters is not farther away than its diameter.
  const double margin = settings_.band + 2 * settings_.balls.most_radius;
  const AlignedBox3d fronts(region_in_body.min() - Vector3d::Constant(margin),
                            region_in_body.max() + Vector3d::Constant(margin));
  const PixelBox box = box_in_image(fronts, body_from_camera.inverse(), camera);
  silhouette_.find(depth, presses, box);
  find_medial_balls(depth, camera, silhouette_, settings_.balls, found_);

  const Eigen::Matrix3f R = body_from_camera.linear().cast<float>();
  const Vector3f t = body_from_camera.translation().cast<float>();
  for (const MedialBall& ball : found_) {
    const Vector3f front = R * ball.front + t, normal = R * ball.normal;
    keep({front, normal, R * ball.centre + t, ball.front.z(), ball.radius});
  }
  const Eigen::AlignedBox3f near = fronts.cast<float>();
  for (int v = box.y; v < box.y + box.height; v += settings_.step) {
    for (int u = box.x; u < box.x + box.width; u += settings_.step) {
      if (!(silhouette_.distance(u, v) > 0)) continue;
      const float z = depth(u, v);
      const Vector3f x = R * camera.unproject(u, v, static_cast<double>(z)).cast<float>() + t;
      if (is_depth(z) && near.contains(x)) cloud_.push_back(x);
    }
  }
  finish();
}

void ObjectSurface::build(std::span<const ObjectBall> balls, const AlignedBox3d& region_in_body,
                          const Vector3f& camera_in_body) {
  start(region_in_body, camera_in_body);
  for (const ObjectBall& ball : balls) {
    keep(ball);
    cloud_.push_back(ball.point);
  }
  finish();
}

NearestOnObject ObjectSurface::answer(const Vector3f& x, float distance, int ball) const {
  const Vector3f& centre = balls_[ball].centre;
  return {distance, ball, (x - centre).dot(camera_ - centre) > 0.0f};
}

std::optional<NearestOnObject> ObjectSurface::nearest(const Vector3f& x) const {
  const auto found = tree_.nearest(x, static_cast<float>(settings_.band));
  if (!found) return std::nullopt;
  return answer(x, found->distance, found->ball);
}

std::optional<NearestOnObject> ObjectSurface::nearest_by_brute_force(const Vector3f& x) const {
  auto best = static_cast<float>(settings_.band);
  int found = -1;
  for (std::size_t k = 0; k < balls_.size(); ++k) {
    const float d = (balls_[k].centre - x).norm() - balls_[k].radius;
    if (d < best) {
      best = d;
      found = static_cast<int>(k);
    }
  }
  if (found < 0) return std::nullopt;
  return answer(x, best, found);
}

}  // namespace palpable
