#include "apps/palpable-bake/solve_obstacle.h"

#include "palpable/base/error.h"
#include "palpable/exchange/vtu_file.h"
#include "palpable/solid/contact.h"
#include "palpable/solid/stress.h"
#include "palpable/truth/obstacle_way.h"

#include <fmt/core.h>

#include <cmath>

namespace palpable::app {
namespace {

void print_head(const ContactWalk& walk) {
  fmt::print(
      "contact points every {:.2f} mm of the skin; the obstacle may be {:.2g} mm inside at one\n\n",
      1e3 * walk.spacing(), 1e3 * ContactSettings{}.largest_entry * walk.body_size());
  fmt::print("{:>6} {:>9} {:>9} {:>9} {:>6} {:>9} {:>9} {:>8} {:>9} {:>7} {:>5} {:>7}\n", "way",
             "Fx/N", "Fy/N", "Fz/N", "points", "gap/mm", "between", "f.gap", "residual", "Newton",
             "CG", "least J");
}

void print_state(const ContactState& state) {
  fmt::print(
      "{:>6.3g} {:>9.4f} {:>9.4f} {:>9.4f} {:>6} {:>9} {:>9.1e} {:>8.1e} {:>9.1e} {:>7} {:>5} "
      "{:>7.3f}\n",
      state.t, state.force.x(), state.force.y(), state.force.z(), state.touching,
      std::isfinite(state.smallest_gap) ? fmt::format("{:.1e}", 1e3 * state.smallest_gap) : "-",
      1e3 * state.entry_between, state.complementarity, state.touching > 0 ? state.residual : 0.0,
      state.newton_steps, state.cg_iterations, state.smallest_volume_ratio);
}

void write_state(const std::string& output, const ContactWalk& walk, const PressSolver& presses) {
  const SolidModel& model = presses.solver().model();
  const Eigen::Matrix3Xd& u = walk.now().displacement;
  const StressField stress = nodal_cauchy_stress(model, u);
  const Eigen::VectorXd mises = von_mises(stress);
  const std::vector<VtuField> fields{{"displacement", u},
                                     {"cauchy_stress", stress},
                                     {"von_mises", mises.transpose()},
                                     {"principal_stresses", principal_stresses(stress)},
                                     {"contact_force", walk.nodal_forces()}};
  write_vtu_file(output, model.mesh, fields);
  fmt::print(
      "{}: displacement up to {:.3f} mm, von Mises stress up to {:.4g} kPa; the obstacle's force "
      "is {:.4g} N",
      output, 1e3 * (u - presses.rest()).colwise().norm().maxCoeff(), 1e-3 * mises.maxCoeff(),
      walk.now().force.norm());
  if (walk.now().touching > 0) {
    const Eigen::Vector3d at = 1e3 * walk.now().centre;
    fmt::print(", at ({:.1f}, {:.1f}, {:.1f}) mm", at.x(), at.y(), at.z());
  } else {
    fmt::print(": it does not touch the body");
  }
  fmt::print("\n");
}

}  // namespace

void solve_obstacle(const ObstacleOptions& options, const std::string& output,
                    const BodyProblem& problem, const PressSolver& presses) {
  const ObstacleMotion way = read_obstacle_way(options.obstacles, options.pose_file);
  ContactSettings settings;
  settings.spacing = 1e-3 * options.spacing_mm;
  ContactWalk walk(presses.solver(), way, 0.0, settings, presses.preloaded());
  fmt::print("{} nodes; {}\n", problem.model.mesh.node_count(), problem.mesh.origin);
  print_head(walk);
  int step = 1;
  for (; step <= options.steps; ++step) {
    if (!walk.advance(static_cast<double>(step) / options.steps)) break;
    print_state(walk.now());
  }
  fmt::print("\n");
  if (step == 1) throw Error(walk.why_stopped());
  if (!walk.why_stopped().empty()) fmt::print("{}\n", walk.why_stopped());
  write_state(output, walk, presses);
}

}  // namespace palpable::app
