#include "palpable/bake/solid/solve_tables.h"

#include <fmt/core.h>

#include <cmath>

namespace palpable {
namespace {

std::string rows_of(const Equilibrium& state, double press) {
  std::string text;
  int number = 0;
  for (const NewtonStep& step : state.convergence) {
    text += fmt::format("{:>8} {:>6} {:>10.1e} {:>6} {:>6.3g}\n",
                        number == 0 ? fmt::format("{:.4g}", state.level) : "", number,
                        step.residual, step.cg_iterations, step.share);
    ++number;
  }
  return text + fmt::format("{:>8} {:>6} {:>10.1e} {:>6} {:>6} {:>11.4f} {:>11.3f}\n",
                            number == 0 ? fmt::format("{:.4g}", state.level) : "", number,
                            state.residual, "", "", 1e3 * press, state.smallest_volume_ratio);
}

}  // namespace

std::string path_table(const PathResult& path, const Eigen::Matrix3Xd& unit_load,
                       const Eigen::Matrix3Xd& rest) {
  std::string text = fmt::format("{:>8} {:>6} {:>10} {:>6} {:>6} {:>11} {:>11}\n", "level",
                                 "Newton", "residual", "CG", "share", "press / mm", "smallest J");
  for (const Equilibrium& state : path.steps) {
    text += rows_of(state, unit_load.cwiseProduct(state.displacement - rest).sum());
  }
  return text;
}

std::string contact_heading() {
  return fmt::format("{:>6} {:>9} {:>9} {:>9} {:>6} {:>9} {:>9} {:>8} {:>9} {:>7} {:>5} {:>7}\n",
                     "way", "Fx/N", "Fy/N", "Fz/N", "points", "gap/mm", "between", "f.gap",
                     "residual", "Newton", "CG", "least J");
}

std::string contact_row(const ContactState& state) {
  return fmt::format(
      "{:>6.3g} {:>9.4f} {:>9.4f} {:>9.4f} {:>6} {:>9} {:>9.1e} {:>8.1e} {:>9.1e} {:>7} {:>5} "
      "{:>7.3f}\n",
      state.t, state.force.x(), state.force.y(), state.force.z(), state.touching,
      std::isfinite(state.smallest_gap) ? fmt::format("{:.1e}", 1e3 * state.smallest_gap) : "-",
      1e3 * state.entry_between, state.complementarity, state.touching > 0 ? state.residual : 0.0,
      state.newton_steps, state.cg_iterations, state.smallest_volume_ratio);
}

}  // namespace palpable
