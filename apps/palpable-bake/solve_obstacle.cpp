#include "apps/palpable-bake/solve_obstacle.h"

#include "apps/common/printing.h"
#include "palpable/bake/pipeline/state_file.h"
#include "palpable/bake/solid/contact.h"
#include "palpable/bake/solid/solve_tables.h"
#include "palpable/bake/truth/obstacle_way.h"
#include "palpable/common/base/error.h"

#include <fmt/format.h>

namespace palpable::app {
namespace {

void write_state(const std::string& output, const ContactWalk& walk, const PressSolver& presses,
                 bool json) {
  const Eigen::Matrix3Xd& u = walk.now().displacement;
  const double mises =
      write_state_file(output, presses.solver().model(), u, {"contact_force", walk.nodal_forces()});
  if (json) {
    Json result{{"file", output},
                {"nodes", presses.solver().model().mesh.node_count()},
                {"largest_displacement_m", (u - presses.rest()).colwise().norm().maxCoeff()},
                {"largest_von_mises_pa", mises},
                {"force_n", walk.now().force.norm()},
                {"touching_points", walk.now().touching},
                {"why_stopped", walk.why_stopped()}};
    print_json(result);
    return;
  }
  print_text(
      "{}: displacement up to {:.3f} mm, von Mises stress up to {:.4g} kPa; the obstacle's force "
      "is {:.4g} N",
      output, 1e3 * (u - presses.rest()).colwise().norm().maxCoeff(), 1e-3 * mises,
      walk.now().force.norm());
  if (walk.now().touching > 0) {
    const Eigen::Vector3d at = 1e3 * walk.now().centre;
    print_text(", at ({:.1f}, {:.1f}, {:.1f}) mm", at.x(), at.y(), at.z());
  } else {
    print_text(": it does not touch the body");
  }
  print_text("\n");
}

}  // namespace

void solve_obstacle(const ObstacleOptions& options, const std::string& output,
                    const BodyProblem& problem, const PressSolver& presses, bool json) {
  const ObstacleMotion way = read_obstacle_way(options.obstacles, options.pose_file);
  ContactSettings settings;
  settings.spacing = options.spacing;
  ContactWalk walk(presses.solver(), way, 0.0, settings, presses.preloaded());
  print_text("{} nodes; {}\n", problem.model.mesh.node_count(), problem.mesh.origin);
  print_text(
      "contact points every {:.2f} mm of the skin; the obstacle may be {:.2g} mm inside at "
      "one\n\n{}",
      1e3 * walk.spacing(), 1e3 * settings.largest_entry * walk.body_size(), contact_heading());
  int step = 1;
  for (; step <= options.steps; ++step) {
    if (!walk.advance(static_cast<double>(step) / options.steps)) break;
    print_text("{}", contact_row(walk.now()));
  }
  print_text("\n");
  if (step == 1) {
    throw Error(fmt::format("--obstacle '{}': {}", fmt::join(options.obstacles, "' and '"),
                            walk.why_stopped()));
  }
  if (!walk.why_stopped().empty()) print_text("{}\n", walk.why_stopped());
  write_state(output, walk, presses, json);
}

}  // namespace palpable::app
