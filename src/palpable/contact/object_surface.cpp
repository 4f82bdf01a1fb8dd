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

}  // namespace

ObjectSurface::ObjectSurface(const ObjectSurfaceSettings& settings)
    : settings_(settings), silhouette_(settings.silhouette), memory_(settings.memory) {
  PALPABLE_EXPECT(settings.step >= 1, "every pixel is the finest decimation");
  PALPABLE_EXPECT(settings.balls.reach >= 1, "a normal needs neighbours");
  PALPABLE_EXPECT(settings.balls.most_radius > 0 && settings.band > 0 &&
                      settings.silhouette.largest_jump_at_1m > 0,
                  "radius, band and jump are lengths above 0");
  PALPABLE_EXPECT(settings.noise_constant >= 0 && settings.noise_linear >= 0 &&
                      settings.noise_quadratic >= 0 && settings.pixels_alike > 0,
                  "noise is not negative");
}

float ObjectSurface::sigma_of(float depth, int pixels) const {
  const auto Z = static_cast<double>(depth);
  const double one =
      settings_.noise_constant + Z * (settings_.noise_linear + Z * settings_.noise_quadratic);
  return static_cast<float>(one / std::sqrt(std::max(1.0, pixels / settings_.pixels_alike)));
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
  bounds_.setEmpty();
  for (const ObjectBall& ball : balls_) {
    bare_.push_back({ball.centre, ball.radius});
    const Vector3f radius = Vector3f::Constant(ball.radius);
    bounds_.extend(Eigen::AlignedBox3f(ball.centre - radius, ball.centre + radius));
  }
  tree_.build(bare_);
}

// The front of a ball that matters is not farther away than its diameter.
AlignedBox3d ObjectSurface::fronts_near(const AlignedBox3d& region) const {
  const Vector3d margin = Vector3d::Constant(settings_.band + 2 * settings_.balls.most_radius);
  return {region.min() - margin, region.max() + margin};
}

PixelBox ObjectSurface::box_of_interest(const AlignedBox3d& region_in_body,
                                        const Rigid3& camera_from_body,
                                        const PinholeCamera& camera) const {
  return box_in_image(fronts_near(region_in_body), camera_from_body, camera);
}

void ObjectSurface::build(const DepthImage& depth, const MaskImage& shows,
                          const PinholeCamera& camera, const Rigid3& body_from_camera,
                          const AlignedBox3d& region_in_body, double time) {
  PALPABLE_EXPECT(depth.width() == camera.width && depth.height() == camera.height,
                  "the camera is the depth image's own");
  start(region_in_body, body_from_camera.translation().cast<float>());
  const Rigid3 camera_from_body = body_from_camera.inverse();
  const PixelBox box = box_of_interest(region_in_body, camera_from_body, camera);
  silhouette_.find(depth, shows, box);
  find_medial_balls(depth, camera, silhouette_, settings_.balls, found_);

  const Eigen::Matrix3f R = body_from_camera.linear().cast<float>();
  const Vector3f t = body_from_camera.translation().cast<float>();
  parts_.find(depth, silhouette_);
  for (const MedialBall& ball : found_) {
    const Vector3f front = R * ball.front + t, normal = R * ball.normal;
    keep({front, normal, R * ball.centre + t, ball.radius, sigma_of(ball.front.z(), ball.pixels),
          parts_.at(ball.x, ball.y)});
  }
  memory_.merge({depth, shows, camera, camera_from_body}, silhouette_, parts_, time, balls_);
  const Eigen::AlignedBox3f near = fronts_near(region_in_body).cast<float>();
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
  return {distance, ball,
          balls_[ball].unseen_for == 0 && (x - centre).dot(camera_ - centre) > 0.0f};
}

std::optional<NearestOnObject> ObjectSurface::nearest(const Vector3f& x, float reach) const {
  const auto found = tree_.nearest(x, reach);
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
