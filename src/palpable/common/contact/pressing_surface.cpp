#include "palpable/common/contact/pressing_surface.h"

#include <algorithm>
#include <cstddef>

namespace palpable {
namespace {

// m of sigma at which the additional compliance of a contact point equals the body's own.
constexpr float kSigmaOfBody = 0.01f;

}  // namespace

void PressingSurface::find_gaps(std::span<const Eigen::Vector3f> places,
                                std::span<SurfaceGap> gaps) const {
  const float reach = band();
  for (std::size_t k = 0; k < places.size(); ++k) {
    gaps[k] = {};
    if (!(bounds().squaredExteriorDistance(places[k]) < reach * reach)) continue;
    const std::optional<SurfaceShape> shape = shape_at(places[k]);
    if (!shape) continue;
    gaps[k].distance = shape->distance;
    gaps[k].normal = shape->normal;
    gaps[k].curvature = shape->curvature;
    gaps[k].softness = shape->sigma / kSigmaOfBody;
    gaps[k].known = shape->known;
    gaps[k].unseen_for = shape->unseen_for;
    gaps[k].friction = kFrictionOfBody * shape->friction_share;
  }
}

std::optional<MaterialPoint> PressingSurface::carried(const MaterialPoint& before) const {
  // The ball nearest to where the place is now: looked for twice.
  MaterialPoint now = before;
  for (int step = 0; step < 2; ++step) {
    const std::optional<NearestOnObject> found = nearest(now.place, band());
    if (!found) return std::nullopt;
    now.place = before.place + balls()[static_cast<std::size_t>(found->ball)].way;
  }
  return now;
}

std::optional<Eigen::Vector3f> PressingSurface::way_of(const MaterialPoint& now) const {
  const std::optional<NearestOnObject> found = nearest(now.place, band());
  if (!found) return std::nullopt;
  return balls()[static_cast<std::size_t>(found->ball)].way;
}

float PressingSurface::depth_at(const Eigen::Vector3f& place) const {
  if (!bounds().contains(place)) return 0;
  const std::optional<NearestOnObject> found = nearest(place, 0);
  return found ? std::max(0.0f, -found->distance) : 0.0f;
}

void PressingSurface::add_sharp_parts(const Eigen::AlignedBox3f& box, float radius,
                                      std::vector<SharpPart>& parts) const {
  if (!bounds().intersects(box)) return;
  for (const ObjectBall& ball : balls()) {
    if (parts.size() == parts.capacity()) return;
    if (!(ball.radius < radius) || !box.contains(ball.centre)) continue;
    parts.push_back({ball.centre, ball.centre, ball.radius, ball.radius});
  }
}

bool PressingSurface::may_be_within(const Eigen::Vector3f& place, float reach) const {
  return bounds().squaredExteriorDistance(place) < reach * reach && is_within(place, reach);
}

}  // namespace palpable
