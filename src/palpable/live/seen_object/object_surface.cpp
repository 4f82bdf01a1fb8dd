#include "palpable/live/seen_object/object_surface.h"

#include "palpable/common/base/contract.h"
#include "palpable/live/seen_object/ray_to_region.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace palpable {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using Eigen::Vector3f;

// Number of balls, and of points of the cloud, for which memory is reserved at the start. A flat
// hand near the camera makes 2,500, and their number varies from frame to frame. More are possible.
constexpr std::size_t kBallRoom = 8192;

// Factor from the sum of the displacements of two builds to moved(). For a thing seen as a whole
// the right one is 1/2, their mean; for one that is cut off, which seems to move half as far, it
// is 1.
constexpr double kSeenMove = 2.0 / 3;

}  // namespace

ObjectSurface::ObjectSurface(const ObjectSurfaceSettings& settings)
    : BallUnion(static_cast<float>(settings.band)),
      settings_(settings),
      silhouette_(settings.silhouette),
      rest_(settings.rest),
      held_(settings.hold),
      on_the_way_(static_cast<float>(settings.band)) {
  PALPABLE_EXPECT(settings.step >= 1, "every pixel is the finest decimation");
  PALPABLE_EXPECT(settings.balls.reach >= 1, "a normal needs neighbours");
  PALPABLE_EXPECT(settings.balls.most_radius > 0 && settings.band > 0 &&
                      settings.silhouette.largest_jump_at_1m > 0,
                  "radius, band and jump are lengths above 0");
  PALPABLE_EXPECT(settings.noise_constant >= 0 && settings.noise_linear >= 0 &&
                      settings.noise_quadratic >= 0 && settings.pixels_alike > 0,
                  "noise is not negative");
  cloud_.reserve(kBallRoom);
  found_.reserve(kBallRoom);
  for (BallUnion* balls : {static_cast<BallUnion*>(this), &on_the_way_}) balls->reserve(kBallRoom);
  before_.reserve(kBallRoom);
  held_.reserve(kBallRoom);
}

double ObjectSurface::noise_at(double Z) const {
  return settings_.noise_constant + Z * (settings_.noise_linear + Z * settings_.noise_quadratic);
}

float ObjectSurface::sigma_of(float depth, int pixels) const {
  return static_cast<float>(noise_at(static_cast<double>(depth)) /
                            std::sqrt(std::max(1.0, pixels / settings_.pixels_alike)));
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
  if (!tree_.balls().empty()) std::swap(tree_, before_);
  arrange();
  find_moved();
}

// Estimates how far things moved since the previous build. A thing that moves by v extends by d . v
// farther in direction d, and v is the least-squares solution over 26 directions. If the picture or
// the region cuts a thing off, only the directions of its visible half change, which gives v / 2.
// Displacements of two builds are added, since an outline that flickers moves there and back.
void ObjectSurface::find_moved() {
  static const std::array<Vector3f, 26> kDirections = [] {
    std::array<Vector3f, 26> directions;
    std::size_t count = 0;
    for (int k = 0; k < 27; ++k) {
      if (k == 13) continue;
      const int x = k % 3, y = k / 3 % 3, z = k / 9;
      directions[count++] =
          (Eigen::Vector3i(x, y, z).cast<float>() - Vector3f::Ones()).normalized();
    }
    return directions;
  }();
  const std::array<float, 26> before = reach_;
  const bool measured_before = measured_;
  reach_.fill(-std::numeric_limits<float>::infinity());
  measured_ = false;
  for (const ObjectBall& ball : balls_) {
    if (ball.unseen_for > 0) continue;
    measured_ = true;
    for (std::size_t k = 0; k < reach_.size(); ++k) {
      reach_[k] = std::max(reach_[k], kDirections[k].dot(ball.point));
    }
  }
  const Vector3f way_before = way_;
  moved_ = 0;
  way_.setZero();
  if (measured_ && measured_before) {
    for (std::size_t k = 0; k < reach_.size(); ++k) {  // the sum of d d^T is 26 / 3
      way_ += 3.0f / 26.0f * (reach_[k] - before[k]) * kDirections[k];
    }
    moved_ = kSeenMove * static_cast<double>((way_ + way_before).norm());
  } else if (balls_.empty() || !measured_before) {
    moved_ = std::numeric_limits<double>::infinity();
  }
}

// The box that holds the fronts of all balls that can reach into the region's band: a front is no
// farther from its ball's surface than the ball's diameter.
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
                          const AlignedBox3d& region_in_body, double time,
                          const Image<float>* coverage) {
  PALPABLE_EXPECT(depth.width() == camera.width && depth.height() == camera.height,
                  "the camera is the depth image's own");
  PALPABLE_EXPECT(
      shows.empty() || (shows.width() == depth.width() && shows.height() == depth.height()),
      "what is shown is of the depth's size");
  PALPABLE_EXPECT(coverage == nullptr ||
                      (coverage->width() == depth.width() && coverage->height() == depth.height()),
                  "shares are of the depth's size");
  start(region_in_body, body_from_camera.translation().cast<float>());
  const Rigid3 camera_from_body = body_from_camera.inverse();
  const PixelBox interest = box_of_interest(region_in_body, camera_from_body, camera);
  const MaskImage& given = shows.empty() ? everything_measured(depth) : shows;
  const Eigen::Matrix3f R = body_from_camera.linear().cast<float>();
  const Vector3f t = body_from_camera.translation().cast<float>();
  const Eigen::AlignedBox3f near = fronts_near(region_in_body).cast<float>();
  const RayToRegion to_body(camera, body_from_camera);
  const PixelBox box = box_of_things(depth, given, camera, interest, to_body, near);
  rest_.add(depth, given, box, camera, camera_from_body, noise_at(1), coverage);
  silhouette_.find(rest_.depth(), rest_.shows(), rest_.box(), &rest_.presence());
  creases_.find(rest_.depth(), camera, silhouette_, settings_.balls.most_radius);
  silhouette_.part(creases_.pixels(),
                   creases_.radius_px() + static_cast<int>(settings_.balls.fattening) + 2);
  find_medial_balls(rest_.depth(), camera, silhouette_, settings_.balls,
                    {body_from_camera, near, region_}, found_);
  for (const MedialBall& ball : found_) {
    const float frames = rest_.frames_at(ball.x, ball.y);
    keep({R * ball.front + t, R * ball.normal, R * ball.centre + t, ball.radius,
          sigma_of(ball.front.z(), ball.pixels) / std::sqrt(frames)});
  }
  held_.recall(depth, given, camera, camera_from_body, time, balls_);
  fill_cloud(depth, given, box, to_body, near);
  finish();
}

// The part of the image that shows pressers near the region, grown by the radius of the largest
// ball in px: outlines up to that far away determine the radii of balls.
PixelBox ObjectSurface::box_of_things(const DepthImage& depth, const MaskImage& shows,
                                      const PinholeCamera& camera, const PixelBox& interest,
                                      const RayToRegion& to_body,
                                      const Eigen::AlignedBox3f& near) const {
  int left = interest.x + interest.width, right = -1, top = interest.y + interest.height,
      bottom = -1;
  float nearest = std::numeric_limits<float>::infinity();
  for (int y = interest.y; y < interest.y + interest.height; ++y) {
    const std::uint8_t *row = shows.row(y), *end = row + interest.x + interest.width;
    const float* depths = depth.row(y);
    for (const std::uint8_t* at = row + interest.x; at != end; ++at) {
      if (*at != kShowsPresser) {
        const void* next = std::memchr(at, kShowsPresser, static_cast<std::size_t>(end - at));
        if (next == nullptr) break;
        at = static_cast<const std::uint8_t*>(next);
      }
      const int x = static_cast<int>(at - row);
      const float z = depths[x];
      if (!near.contains(to_body.point(x, y, z))) continue;
      left = std::min(left, x), right = std::max(right, x);
      top = std::min(top, y), bottom = y;
      nearest = std::min(nearest, z);
    }
  }
  if (right < 0) return {};
  const double beside = camera.fx_px * settings_.balls.most_radius / static_cast<double>(nearest) +
                        settings_.balls.fattening + 2;
  const PixelBox box = grown({left, top, right - left + 1, bottom - top + 1},
                             static_cast<int>(std::min(beside, 64.0)), camera);
  const int x = std::max(box.x, interest.x), y = std::max(box.y, interest.y);
  return {x, y, std::min(box.x + box.width, interest.x + interest.width) - x,
          std::min(box.y + box.height, interest.y + interest.height) - y};
}

void ObjectSurface::fill_cloud(const DepthImage& depth, const MaskImage& shows, const PixelBox& box,
                               const RayToRegion& to_body, const Eigen::AlignedBox3f& near) {
  const int step = settings_.step;
  const auto first = [&](int from) { return (from + step - 1) / step * step; };
  cloud_.reserve(static_cast<std::size_t>(first(depth.width()) / step) *
                 static_cast<std::size_t>(first(depth.height()) / step));
  for (int v = first(box.y); v < box.y + box.height; v += step) {
    for (int u = first(box.x); u < box.x + box.width; u += step) {
      if (shows(u, v) != kShowsPresser || !is_depth(depth(u, v))) continue;
      const Vector3f x = to_body.point(u, v, depth(u, v));
      if (near.contains(x)) cloud_.push_back(x);
    }
  }
}

const MaskImage& ObjectSurface::everything_measured(const DepthImage& depth) {
  all_.resize(depth.width(), depth.height());
  for (std::size_t i = 0; i < all_.size(); ++i) {
    all_.data()[i] = is_depth(depth.data()[i]) ? kShowsPresser : kShowsUnknown;
  }
  return all_;
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

void ObjectSurface::set_motion(std::span<const BallMotion> motion) {
  PALPABLE_EXPECT(motion.size() == balls_.size(), "the motion of each ball");
  for (std::size_t k = 0; k < motion.size(); ++k) {
    balls_[k].way = motion[k].way;
    balls_[k].friction_share = motion[k].friction_share;
    balls_[k].way_is_mean = motion[k].way_is_mean;
  }
  find_friction_share();
}

const Obstacles* ObjectSurface::on_the_way(float done) const {
  if (!(friction_share() > 0)) return nullptr;
  on_the_way_.set_on_the_way(*this, done);
  return &on_the_way_;
}

float ObjectSurface::largest_way() const {
  float largest = 0;
  for (const ObjectBall& ball : balls()) largest = std::max(largest, ball.way.squaredNorm());
  return std::sqrt(largest);
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
  return on_ball(x, best, found);
}

}  // namespace palpable
