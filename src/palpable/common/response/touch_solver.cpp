#include "palpable/common/response/touch_solver.h"

#include <array>

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
  body_->use(state);
  const std::array near{ContactSolver::Near{&obstacles, largest_move}};
  solver_.advance(near, time);
  return report_of(*body_, solver_, 0);
}

}  // namespace palpable
