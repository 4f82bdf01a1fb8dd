#include "palpable/common/contact/skin_contact.h"

#include <algorithm>
#include <cstddef>
#include <optional>

namespace palpable {
namespace {

using Eigen::Vector3f;

// m of sigma that make a point as compliant as the body is there.
constexpr float kSigmaOfBody = 0.01f;

}  // namespace

GapQuery gaps_to(const PressingSurface& seen) {
  const auto reach = seen.band();
  return [&seen, reach](const Vector3f& place, SurfaceGap& gap) {
    if (!(seen.bounds().squaredExteriorDistance(place) < reach * reach)) return false;
    const std::optional<SurfaceShape> shape = seen.shape_at(place);
    if (!shape) return false;
    gap.distance = shape->distance;
    gap.normal = shape->normal;
    gap.curvature = shape->curvature;
    gap.softness = shape->sigma / kSigmaOfBody;
    return true;
  };
}

NearQuery near_to(const PressingSurface& seen) {
  return [&seen](const Vector3f& place, float reach) {
    return seen.bounds().squaredExteriorDistance(place) < reach * reach &&
           seen.is_within(place, reach);
  };
}

SkinContact::SkinContact(const SurfaceMesh& skin, std::span<const std::uint8_t> fixed,
                         const TouchTables& tables, const TouchSettings& settings)
    : solver_(skin, fixed, tables, settings),
      patches_(4 * TouchSolver::kMostPoints),
      pressure_(skin) {
  moved_.reserve(2 * TouchSolver::kMostPoints);
}

TouchReport SkinContact::advance(TouchState& state, const PressingSurface& seen,
                                 std::vector<Touch>& touches) {
  touches.clear();
  touches.reserve(TouchSolver::kMostPoints);
  TouchReport report;
  if (seen.balls().empty() && state.forces.empty() && state.u.cols() > 0) {
    return report;  // at rest, and stays so
  }
  report = solver_.advance(state, gaps_to(seen), near_to(seen), largest_move(seen));
  find_pressed(state);
  patches_.find(seen, touches);
  return report;
}

double SkinContact::largest_move(const PressingSurface& seen) {
  return std::max(kMove, seen.moved());
}

void SkinContact::find_touches(const TouchState& state, const PressingSurface& seen,
                               std::span<const PressedPoint> others, std::vector<Touch>& touches) {
  touches.reserve(TouchSolver::kMostPoints);
  find_pressed(state);
  for (const PressedPoint& point : others) patches_.points().push_back(point);
  patches_.find(seen, touches);
}

void SkinContact::find_pressed(const TouchState& state) {
  patches_.points().clear();
  solver_.find_moved(state, moved_);
  for (std::size_t k = 0; k < moved_.size(); ++k) {
    const PointForce& at = state.forces[k];
    const SkinPoint& point = solver_.points()[static_cast<std::size_t>(at.point)];
    patches_.points().push_back(
        {solver_.places().col(at.point) + moved_[k], moved_[k], at.force, point.area, at.by});
  }
}

}  // namespace palpable
