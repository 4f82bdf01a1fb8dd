// palpable solve BODY.toml --site 5 --level 0.7 -o x.vtu

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/palpable-bake/body_report.h"
#include "apps/palpable-bake/commands.h"
#include "apps/palpable-bake/description_argument.h"
#include "apps/palpable-bake/solve_obstacle.h"
#include "palpable/bake/campaign/press_solver.h"
#include "palpable/bake/describe/body_problem.h"
#include "palpable/bake/describe/material_warnings.h"
#include "palpable/bake/pipeline/state_file.h"
#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/solid/solve_tables.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/file_format.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/output_name.h"
#include "palpable/common/base/progress.h"
#include "palpable/common/geometry/size_text.h"

#include <fmt/core.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace palpable::app {
namespace {

struct SolveOptions {
  std::string description;
  std::string output;
  int site = 0;
  double level = 1.0;
  int order = 0;  // 0: as in the description
  ObstacleOptions obstacle;
  bool json = false;
};

// The description's load levels below `level`, and `level`.
std::vector<double> levels_to(double level, int count) {
  std::vector<double> levels;
  for (int l = 1; l <= count; ++l) {
    const double at = static_cast<double>(l) / count;
    if (at < level * (1.0 - 1e-9)) levels.push_back(at);
  }
  levels.push_back(level);
  return levels;
}

BodyDescription wanted_description(const SolveOptions& options) {
  BodyDescription description = read_description(options.description);
  if (options.order > 0) {
    description.shape.order = options.order;
    description.shape.order_place = "--order";
  }
  return description;
}

BodyProblem posed(const SolveOptions& options, const BodyDescription& description) {
  BodyProblem problem = pose_body(description);
  if (options.site >= static_cast<int>(problem.sites.size())) {
    throw Error(fmt::format("{}: there is no site {}; the body has 0 to {}", options.description,
                            options.site, problem.sites.size() - 1));
  }
  return problem;
}

void print_problem(const BodyDescription& description, const BodyProblem& problem,
                   const PressSolver& presses, int number) {
  print_text("{}", problem_text(description, problem));
  if (presses.is_preloaded()) {
    print_text(
        "gravity, pressures and moved supports come first: nodes move by up to {:.4g} mm, presses "
        "are counted from there\n",
        1e3 * presses.rest().colwise().norm().maxCoeff());
  }
  const Site& site = problem.sites[number];
  const Eigen::Vector3d at = problem.mesh.boundary.surface.vertices.col(site.vertex);
  print_text("site {} at ({:.1f}, {:.1f}, {:.1f}) mm, pressed along ({:.3f}, {:.3f}, {:.3f})\n",
             number, 1e3 * at[0], 1e3 * at[1], 1e3 * at[2], site.direction[0], site.direction[1],
             site.direction[2]);
}

struct FullLoad {
  double load = 0;        // N
  std::string shortfall;  // why it is less than what the description asks for; empty: it is not
};

// The force of the description, or the force that presses to the depth of the description.
FullLoad find_full_load(const SolveOptions& options, const BodyProblem& problem,
                        const PressSolver& presses, const Eigen::Matrix3Xd& unit) {
  if (problem.force > 0.0) {
    print_text("level 1 is {:.4g} N\n\n", problem.force);
    return {problem.force, {}};
  }
  const LoadSearch search = presses.find_load(unit, problem.press);
  if (!(search.load > 0.0)) {
    throw Error(fmt::format("{}: {}, cannot be pressed: {}", options.description,
                            site_text(problem, options.site), search.why_stopped));
  }
  print_text("level 1 is {:.4g} N, which press it in by {:.3f} mm{}{}\n\n", search.load,
             1e3 * search.press, search.reached ? "" : ": ", search.why_stopped);
  return {search.load, search.reached ? std::string() : search.why_stopped};
}

// Prints the equilibrium path. @throws Error when not even the first level was reached
void print_path(const SolveOptions& options, const BodyDescription& description,
                const BodyProblem& problem, const PathResult& path, const Eigen::Matrix3Xd& unit,
                const PressSolver& presses) {
  print_text("{}\n", path_table(path, unit, presses.rest()));
  if (path.steps.empty()) {
    throw Error(fmt::format("{}: {}: {}. Young's modulus is {}", options.description,
                            site_text(problem, options.site), path.why_stopped,
                            young_words(description)));
  }
}

// Says where a body hardly moves. @throws Error where less was reached than was asked for
void say_how_it_ended(const SolveOptions& options, const BodyDescription& description,
                      const PressSolver& presses, const FullLoad& full, const PathResult& path,
                      double mises) {
  const Equilibrium& last = path.steps.back();
  const std::string& why = path.complete ? full.shortfall : path.why_stopped;
  if (!why.empty()) {
    throw Error(fmt::format(
        "{}: not the press that was asked for: {}. Young's modulus is {}; {} holds the last "
        "state that was reached, {:.4g} N",
        options.description, why, young_words(description), options.output,
        last.level * full.load));
  }
  const Eigen::Matrix3Xd& X = presses.solver().model().mesh.nodes;
  const Movement movement{(last.displacement - presses.rest()).colwise().norm().maxCoeff(),
                          extent_of(X).maxCoeff(), last.level * full.load};
  if (const auto text = hardly_moves_text(description, movement)) print_text("{}\n", *text);
  const FullPress press{last.level * full.load, mises};
  if (const auto text = absurd_press_text(description, press)) {
    fmt::print(stderr, "warning: {}: {}\n", options.description, *text);
  }
}

// The body under the loads that act before it is pressed.
PressSolver preloaded(const SolveOptions& options, const BodyDescription& description,
                      const EquilibriumSolver& solver, const BodyProblem& problem) {
  try {
    return PressSolver(solver, problem.preload, problem.press_range);
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}; it is {}", options.description, error.what(),
                            preload_words(description)));
  }
}

// The files that a solve reads. An obstacle may also be a shape, whose text names no file.
std::vector<std::filesystem::path> inputs_of(const SolveOptions& options,
                                             const BodyDescription& description) {
  std::vector<std::filesystem::path> inputs{options.description, description.shape.file,
                                            options.obstacle.pose_file};
  inputs.insert(inputs.end(), options.obstacle.obstacles.begin(), options.obstacle.obstacles.end());
  return inputs;
}

void solve(const SolveOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  const BodyDescription description = wanted_description(options);
  guard_output_file(options.output, inputs_of(options, description));
  require_ending(options.output, {".vtu"}, "a VTK grid");
  guard_format(options.output, FileFormat::kXml);
  print_size(description);
  const BodyProblem problem = posed(options, description);
  const EquilibriumSolver solver(problem.model);
  const PressSolver presses = preloaded(options, description, solver, problem);
  if (options.obstacle.obstacles.empty() && !options.obstacle.pose_file.empty()) {
    throw Error("--poses: says where an --obstacle goes; there is none");
  }
  if (!options.obstacle.obstacles.empty()) {
    solve_obstacle(options.obstacle, options.output, problem, presses, options.json);
    return;
  }
  refuse_press_through(description, problem);
  refuse_beyond_range(description, problem);
  print_problem(description, problem, presses, options.site);
  const Eigen::Matrix3Xd unit = unit_load(problem.sites[options.site], problem.mesh.boundary,
                                          problem.model.mesh.node_count());
  const FullLoad full = find_full_load(options, problem, presses, unit);
  const PathResult path =
      presses.solve_path(full.load * unit, levels_to(options.level, description.press.levels));
  print_path(options, description, problem, path, unit, presses);

  const Equilibrium& last = path.steps.back();
  Eigen::Matrix3Xd load = last.level * full.load * unit;
  if (problem.preload.cols() > 0) load += problem.preload;
  const double mises =
      write_state_file(options.output, solver.model(), last.displacement, {"load", load});
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  const double largest = last.displacement.colwise().norm().maxCoeff();
  if (options.json) {
    print_json({{"file", options.output},
                {"nodes", problem.model.mesh.node_count()},
                {"site", options.site},
                {"level", last.level},
                {"load_n", last.level * full.load},
                {"complete", path.complete && full.shortfall.empty()},
                {"largest_displacement_m", largest},
                {"largest_von_mises_pa", mises},
                {"seconds", taken.count()}});
  } else {
    print_text("{}: level {:.4g}, displacement up to {}, von Mises stress up to {:.4g} kPa; {}\n",
               options.output, last.level, millimetres(largest), 1e-3 * mises,
               duration_text(taken.count()));
  }
  if (!options.json) print_text("{}\n", full_press_text(description, {full.load, mises}));
  say_how_it_ended(options, description, presses, full, path, mises);
}

}  // namespace

void add_solve(Command app) {
  const auto options = std::make_shared<SolveOptions>();
  Command command =
      app.add_subcommand("solve", "Press a body at one site and write it for ParaView");
  add_description(command, options->description);
  command.add_option("-o,--out", options->output, "VTK grid to write")
      .type_name("FILE.vtu")
      .required();
  command.add_option("--site", options->site, "Which of the description's sites, from 0")
      .not_negative()
      .show_default();
  command
      .add_option(
          "--level", options->level,
          "Share of the description's full press: its force, or the load that gives its depth")
      .in_range(1e-6, 1.0)
      .show_default();
  command
      .add_option("--order", options->order,
                  "1: 4-node tetrahedra; 2: 10-node ones, far more accurate")
      .in_range(1, 2)
      .default_is("as the description says");
  command.add_option("--obstacle", options->obstacle.obstacles,
                     "Instead of a site: a rigid thing that presses the body on its way from 'at' "
                     "to 'to', \"sphere 8mm at 0,0,0.16 to 0,0,0.14\", \"capsule R,R at X,Y,Z and "
                     "X,Y,Z to X,Y,Z\", \"plane NORMAL at X,Y,Z to X,Y,Z\" (m, body frame), or a "
                     "closed surface's file; may be given several times");
  command.add_option("--poses", options->obstacle.pose_file,
                     "Where surfaces among the obstacles go: lines \"time tx ty tz qx qy qz qw\", "
                     "body_from_surface");
  command.add_option("--steps", options->obstacle.steps, "Steps in which obstacles go their way")
      .in_range(1, 10000)
      .show_default();
  command.add_length("--spacing", options->obstacle.spacing, "Distance between contact points")
      .default_is("a third of the skin's edges, at most half the smallest radius");
  command.add_json(options->json);
  command.footer(
      "Example: palpable solve bodies/bunny-demo.toml --obstacle \"sphere 8mm at "
      "0.02,0,0.105 to 0.02,0,0.085\" -o x.vtu\n"
      "Example: palpable solve bodies/bunny-demo.toml --site 5 --level 0.7 -o x.vtu");
  command.callback([options] { solve(*options); });
}

}  // namespace palpable::app
