#include "palpable/common/contact/pressing_surface.h"

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
  }
}

bool PressingSurface::may_be_within(const Eigen::Vector3f& place, float reach) const {
  return bounds().squaredExteriorDistance(place) < reach * reach && is_within(place, reach);
}

}  // namespace palpable
