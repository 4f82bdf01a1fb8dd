#include "palpable/common/response/touch_solver.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace palpable {

TouchReport report_of(const TablesBody& body, const ContactSolver& solver, int member) {
  TouchReport report;
  static_cast<ContactReport&>(report) = solver.report_of(member);
  const bool is_solution = !(report.unsolved() > 0) && !report.stuck;
  report.penetration = solver.penetration_of(member);
  const TablesReport& tables = body.report();
  report.patches = tables.patches;
  report.last_share = tables.last_share;
  report.indicators = tables.indicators;
  if (is_solution) report.stated = tables.stated;
  return report;
}

TouchSolver::TouchSolver(const SurfaceMesh& skin, std::span<const std::uint8_t> fixed,
                         const TouchTables& tables, const TouchSettings& settings)
    : body_(std::make_unique<TablesBody>(skin, fixed, tables, settings)),
      solver_({{body_.get(), Rigid3::Identity()}}) {}

TouchReport TouchSolver::advance(TouchState& state, const Obstacles& obstacles, double largest_move,
                                 std::optional<double> time) {
  use(state);
  const std::array near{ContactSolver::Near{&obstacles, largest_move}};
  solver_.advance(near, time);
  return report_of(*body_, solver_, 0);
}

ContactReport TouchSolver::tick(TouchState& state, const Obstacles& obstacles, double h,
                                double way) {
  use(state);
  return solver_.tick({&obstacles}, h, way);
}

void TouchSolver::find_moved(const TouchState& state, std::vector<Eigen::Vector3f>& moved) const {
  body_->find_moved(state, moved);
  if (!solver_.ticks() || used_ != &state) return;
  for (const Contact& contact : solver_.contacts()) {
    const auto at = std::lower_bound(state.forces.begin(), state.forces.end(),
                                     PointForce{contact.point, {}, contact.by}, stands_before);
    if (at == state.forces.end() || at->point != contact.point) continue;
    moved[static_cast<std::size_t>(at - state.forces.begin())] =
        solver_.position_of(contact) - body_->points_at_rest().col(contact.point);
  }
}

// Ticks of another state end where they are.
void TouchSolver::use(TouchState& state) {
  if (used_ != &state || state.u.cols() == 0) solver_.drop_ticks();
  used_ = &state;
  body_->use(state);
}

}  // namespace palpable
