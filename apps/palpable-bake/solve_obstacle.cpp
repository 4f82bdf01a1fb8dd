#include "apps/palpable-bake/solve_obstacle.h"

#include "palpable/bake/pipeline/state_file.h"
#include "palpable/bake/solid/contact.h"
#include "palpable/bake/solid/solve_tables.h"
#include "palpable/bake/truth/obstacle_way.h"
#include "palpable/common/base/error.h"

#include <fmt/format.h>

namespace palpable::app {
namespace {

void write_state(const std::string& output, const ContactWalk& walk, const PressSolver& presses) {
  const Eigen::Matrix3Xd& u = walk.now().displacement;
  const double mises =
      write_state_file(output, presses.solver().model(), u, {"contact_force", walk.nodal_forces()});
  fmt::print(
      "{}: displacement up to {:.3f} mm, von Mises stress up to {:.4g} kPa; the obstacle's force "
      "is {:.4g} N",
      output, 1e3 * (u - presses.rest()).colwise().norm().maxCoeff(), 1e-3 * mises,
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
  fmt::print(
      "contact points every {:.2f} mm of the skin; the obstacle may be {:.2g} mm inside at "
      "one\n\n{}",
      1e3 * walk.spacing(), 1e3 * settings.largest_entry * walk.body_size(), contact_heading());
  int step = 1;
  for (; step <= options.steps; ++step) {
    if (!walk.advance(static_cast<double>(step) / options.steps)) break;
    fmt::print("{}", contact_row(walk.now()));
  }
  fmt::print("\n");
  if (step == 1) {
    throw Error(fmt::format("--obstacle '{}': {}", fmt::join(options.obstacles, "' and '"),
                            walk.why_stopped()));
  }
  if (!walk.why_stopped().empty()) fmt::print("{}\n", walk.why_stopped());
  write_state(output, walk, presses);
}

}  // namespace palpable::app
