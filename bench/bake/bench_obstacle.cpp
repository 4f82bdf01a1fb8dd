// palpable-bake bench obstacle: compares contact with Hertz's solution and with CalculiX, and
// measures it on a body.

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "palpable/bake/campaign/press_solver.h"
#include "palpable/bake/describe/body_problem.h"
#include "palpable/bake/solid/hertz_block.h"
#include "palpable/common/base/cpu_time.h"
#include "palpable/common/base/error.h"

#include <fmt/core.h>

#include "bench/bake/bench.h"
#include "bench/bake/contact_comparison.h"
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace palpable::app {
namespace {

struct BenchObstacleOptions {
  std::string body = "bodies/bunny-demo.toml";
  std::vector<int> hertz{12, 17, 24, 28};  // numbers of cells
  bool json = false;
};

Json hertz_figures(const BenchObstacleOptions& options, ProgressBar& bar) {
  std::vector<HertzResult> results;
  Json list = Json::array();
  const auto total = static_cast<double>(options.hertz.size());
  std::vector<int> sizes = options.hertz;
  std::sort(sizes.begin(), sizes.end());
  sizes.erase(std::unique(sizes.begin(), sizes.end()), sizes.end());
  for (const int cells : sizes) {
    bar.show({"Hertz's block", static_cast<double>(results.size()), total, ""});
    results.push_back(press_hertz_block(cells));
    const HertzResult& r = results.back();
    list.push_back({{"nodes", r.nodes},
                    {"cell_over_radius", r.cell},
                    {"force_error", r.force_error},
                    {"radius_error", r.radius_error},
                    {"pressure_error", r.pressure_error}});
  }
  const HertzResult &first = results.front(), &last = results.back();
  Json figures = {{"hertz", list}, {"hertz_force_error", last.force_error}};
  if (results.size() > 1) {
    figures["hertz_order"] =
        std::log(std::abs(first.force_error / last.force_error)) / std::log(first.cell / last.cell);
  }
  return figures;
}

Json calculix_figures(ProgressBar& bar) {
  bar.show({"CalculiX' contact", 0, 1, ""});
  const std::vector<ContactDifference> differences = compare_contact(8, {10, 100, 1000});
  Json list = Json::array();
  for (const ContactDifference& d : differences) {
    list.push_back({{"stiffness", d.stiffness}, {"u", d.displacement}, {"force", d.force}});
  }
  return {{"ccx", list},
          {"ccx_difference_u", differences.back().displacement},
          {"ccx_difference_force", differences.back().force}};
}

// A fingertip that moves down onto the highest point of the body, by a tenth of its height.
Json body_figures(const BenchObstacleOptions& options, ProgressBar& bar) {
  constexpr int kSteps = 10;
  constexpr double kRadius = 8e-3;
  const BodyDescription description = read_body_description(options.body);
  const BodyProblem problem = pose_body(description);
  const EquilibriumSolver solver(problem.model);
  const PressSolver presses(solver, problem.preload);
  const Eigen::Matrix3Xd& skin = problem.mesh.boundary.surface.vertices;
  Eigen::Index highest = 0;
  skin.row(2).maxCoeff(&highest);
  const Eigen::Vector3d top = skin.col(highest) + Eigen::Vector3d(0, 0, kRadius);
  const double deep = 0.1 * problem.mesh.height;
  const auto way = [=](double t) {
    return Obstacle{.capsules = {ball(top - Eigen::Vector3d(0, 0, t * deep), kRadius)}};
  };
  ContactWalk walk(solver, way, 0.0, {}, presses.preloaded());
  double complementarity = 0.0, entry = 0.0;
  const double begin = thread_cpu_seconds();
  for (int step = 1; step <= kSteps; ++step) {
    bar.show({"a finger on " + description.name, static_cast<double>(step), kSteps, ""});
    if (!walk.advance(static_cast<double>(step) / kSteps)) {
      throw Error(options.body + ": " + walk.why_stopped());
    }
    complementarity = std::max(complementarity, walk.now().complementarity);
    entry = std::max(entry, walk.now().entry_between);
  }
  return {{"nodes", problem.model.mesh.node_count()},
          {"complementarity", complementarity},
          {"entry_between_mm", 1e3 * entry},
          {"force_N", walk.now().force.norm()},
          {"s_per_solve", (thread_cpu_seconds() - begin) / kSteps}};
}

void bench_obstacle(const BenchObstacleOptions& options) {
  ProgressBar bar;
  Json figures = hertz_figures(options, bar);
  figures.update(calculix_figures(bar));
  figures.update(body_figures(options, bar));
  bar.finish();
  print_figures(figures, options.json);
}

}  // namespace

void add_bench_obstacle(Command bench) {
  const auto options = std::make_shared<BenchObstacleOptions>();
  Command command = bench.add_subcommand(
      "obstacle", "Contact: against Hertz, against CalculiX, and on a body (minutes)");
  command.add_option("body", options->body, "The body that a finger presses")
      .type_name("FILE.toml")
      .show_default();
  command.add_option("--hertz", options->hertz, "Cells along the edges of Hertz's blocks")
      .in_range(4, 64)
      .show_default();
  command.add_json(options->json);
  command.footer("Example: palpable bench obstacle bodies/bunny-demo.toml --json");
  command.callback([options] { bench_obstacle(*options); });
}

}  // namespace palpable::app
