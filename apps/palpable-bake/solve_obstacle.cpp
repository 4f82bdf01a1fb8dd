#include "apps/palpable-bake/solve_obstacle.h"

#include "apps/common/printing.h"
#include "apps/palpable-bake/body_report.h"
#include "palpable/bake/pipeline/state_file.h"
#include "palpable/bake/solid/contact.h"
#include "palpable/bake/solid/obstacle_jump.h"
#include "palpable/bake/solid/solve_tables.h"
#include "palpable/bake/truth/obstacle_way.h"
#include "palpable/common/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <string>

namespace palpable::app {
namespace {

// Distance of an obstacle at the end of its way, ratio to the body's diagonal, that gets a warning.
// One that only comes near, or goes past, stays well within the body's size.
constexpr double kFarObstacle = 2.0;

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
      "{}: displacement up to {}, von Mises stress up to {:.4g} kPa; the obstacle's force "
      "is {:.4g} N",
      output, millimetres((u - presses.rest()).colwise().norm().maxCoeff()), 1e-3 * mises,
      walk.now().force.norm());
  if (walk.now().touching > 0) {
    const Eigen::Vector3d at = 1e3 * walk.now().centre;
    print_text(", at ({:.1f}, {:.1f}, {:.1f}) mm", at.x(), at.y(), at.z());
  } else {
    print_text(": it does not touch the body");
  }
  print_text("\n");
}

// An obstacle that passes the body by far is more often in the wrong unit than meant.
void warn_of_far_obstacle(const ObstacleMotion& way, const ContactWalk& walk,
                          const BodyProblem& problem) {
  if (walk.now().touching > 0) return;
  const ObstacleGaps gaps(way(1.0));
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& x : problem.mesh.boundary.surface.vertices.colwise()) {
    nearest = std::min(nearest, gaps.distance(x));
  }
  if (nearest <= kFarObstacle * walk.body_size()) return;
  fmt::print(stderr,
             "warning: --obstacle: it ends {:.4g} mm from the body, which is {:.4g} mm large: its "
             "coordinates are m in the body frame, where the body stands on Z = 0\n",
             1e3 * nearest, 1e3 * walk.body_size());
}

SurfaceMesh skin_at(const BodyProblem& problem, const Eigen::Matrix3Xd& u) {
  const Boundary& boundary = problem.mesh.boundary;
  SurfaceMesh skin = boundary.surface;
  for (int v = 0; v < skin.vertex_count(); ++v) {
    skin.vertices.col(v) += u.col(boundary.node_of_vertex[v]);
  }
  return skin;
}

// Goes one step. @throws Error when the obstacle went through the body within it
bool go_step(ContactWalk& walk, const ObstacleMotion& way, const BodyProblem& problem, double t) {
  const double from = walk.now().t;
  const bool touched = walk.now().touching > 0;
  const SurfaceMesh skin = skin_at(problem, walk.now().displacement);
  if (!walk.advance(t)) return false;
  if (walk.now().touching > 0) return true;
  const std::optional<Overlap> jump =
      overlap_between(way, skin, from, t, touched ? OverlapOf::kCore : OverlapOf::kAnyPoint);
  if (!jump) return true;
  throw Error(fmt::format(
      "--obstacle: goes through the body between t = {:.4g} and {:.4g} without touching "
      "it at the end of a step: give --steps {} or more, or a shorter way",
      from, t, steps_to_meet(*jump)));
}

}  // namespace

void solve_obstacle(const ObstacleOptions& options, const std::string& output,
                    const BodyProblem& problem, const PressSolver& presses, bool json) {
  const ObstacleMotion way = read_obstacle_way(options.obstacles, options.pose_file);
  const SurfaceMesh at_rest = skin_at(problem, presses.rest());
  if (const std::string why = swallowed_text(way(0.0), at_rest); !why.empty()) {
    throw Error(fmt::format("--obstacle '{}': {}", fmt::join(options.obstacles, "' and '"), why));
  }
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
    if (!go_step(walk, way, problem, static_cast<double>(step) / options.steps)) break;
    print_text("{}", contact_row(walk.now()));
  }
  print_text("\n");
  if (step == 1) {
    throw Error(fmt::format("--obstacle '{}': {}", fmt::join(options.obstacles, "' and '"),
                            walk.why_stopped()));
  }
  write_state(output, walk, presses, json);
  if (!walk.why_stopped().empty()) {
    throw Error(fmt::format("--obstacle '{}': {}; {} holds the last state that was reached",
                            fmt::join(options.obstacles, "' and '"), walk.why_stopped(), output));
  }
  warn_of_far_obstacle(way, walk, problem);
}

}  // namespace palpable::app
