#include "palpable/common/response/skin_contact.h"

#include <algorithm>
#include <cstddef>

namespace palpable {

using Eigen::Vector3f;

SkinContact::SkinContact(const SurfaceMesh& skin, std::span<const std::uint8_t> fixed,
                         const TouchTables& tables, const TouchSettings& settings)
    : solver_(skin, fixed, tables, settings),
      patches_(4 * TouchSolver::kMostPoints),
      pressure_(skin) {
  moved_.reserve(2 * TouchSolver::kMostPoints);
}

TouchReport SkinContact::advance(TouchState& state, const PressingSurface& seen,
                                 std::vector<Touch>& touches, std::optional<double> time) {
  touches.clear();
  touches.reserve(TouchSolver::kMostPoints);
  TouchReport report;
  if (seen.balls().empty() && state.forces.empty() && state.u.cols() > 0 &&
      !state.vibration.moves) {
    return report;  // at rest, and stays so
  }
  report = solver_.advance(state, seen, largest_move(seen), time);
  find_pressed(state);
  patches_.find(&seen, touches);
  return report;
}

double SkinContact::largest_move(const PressingSurface& seen) {
  return std::max(kMove, seen.moved());
}

void SkinContact::find_touches(const TouchState& state, const Obstacles* seen,
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
    patches_.points().push_back({solver_.places().col(at.point) + moved_[k], moved_[k], at.force,
                                 point.area, at.by, at.friction});
  }
}

}  // namespace palpable
