// palpable-bake bench solid: compares one equilibrium path with CalculiX's on the same mesh under
// the same loads, in CPU time and accuracy.

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "palpable/bake/describe/body_problem.h"
#include "palpable/bake/describe/contact_sites.h"
#include "palpable/bake/solid/loads.h"
#include "palpable/common/base/cpu_time.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/common/base/this_machine.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "bench/bake/bench.h"
#include "bench/bake/calculix_comparison.h"
#include "bench/bake/machine_rates.h"
#include "bench/bake/solid_tables.h"
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
struct BenchSolidOptions {
  std::string description = "bodies/bunny.toml";
  std::string law = "neo-hooke-abaqus";
  std::vector<int> sites{0, 3, 1};  // of the bunny: an ear, the back, low at the base
  int levels = 26;
  int repeats = 3;
  std::string program = "ccx";
  bool verify = false;
  bool ours_only = false;
  bool json = false;
};

constexpr double kTolerance = 1e-8;  // of both programs
// Ratio to the last load that both programs reach: convergence on the last part of the path
// depends on chance.
constexpr double kShareOfLast = 0.95;

double median(std::vector<double> values) { return percentile(std::move(values), 0.5); }

std::vector<double> even_levels(int count) {
  std::vector<double> levels;
  for (int k = 1; k <= count; ++k) levels.push_back(static_cast<double>(k) / count);
  return levels;
}

// One of our paths, including construction of the solver and the factor of the undeformed body.
struct OurPath {
  PathResult path;
  double cpu_s = 0;    // median of the repeats; all other members are of that repeat
  double setup_s = 0;  // part of cpu_s: construction of the solver
  SolverSetup setup;
};
OurPath solve_ours(const SolidModel& model, const Matrix3Xd& load,
                   const std::vector<double>& levels, int repeats) {
  std::vector<OurPath> runs(repeats);
  for (OurPath& run : runs) {
    const double begin = process_cpu_seconds();
    const EquilibriumSolver solver(model, {.tolerance = kTolerance});
    run.setup_s = process_cpu_seconds() - begin;
    run.path = solver.solve_path(load, levels);
    run.cpu_s = process_cpu_seconds() - begin;
    run.setup = solver.setup();
  }
  std::sort(runs.begin(), runs.end(),
            [](const OurPath& a, const OurPath& b) { return a.cpu_s < b.cpu_s; });
  return std::move(runs[runs.size() / 2]);
}

struct Counts {
  int newton = 0, cg = 0;
};
Counts counts_of(const PathResult& path) {
  Counts counts;
  for (const Equilibrium& step : path.steps) {
    counts.newton += step.newton_steps;
    counts.cg += step.cg_iterations;
  }
  return counts;
}

// Distribution of the CPU time.
Json stages_of(const OurPath& ours) {
  const SolverSetup& setup = ours.setup;
  const SolveTimes& times = ours.path.times;
  const double tangent = setup.tangent_s + times.tangent_s;
  const double factor = setup.factor_s + times.factor_s;
  const double solve = times.precondition_s + times.product_s;
  const double before = setup.pattern_s + setup.ordering_s;
  return {{"pattern_and_ordering", before},
          {"tangent", tangent},
          {"factor", factor},
          {"solve", solve},
          {"solve_preconditioner", times.precondition_s},
          {"solve_products", times.product_s},
          {"force", times.force_s},
          {"rest", ours.cpu_s - before - tangent - factor - solve - times.force_s}};
}

Json path_json(const OurPath& ours) {
  const Counts counts = counts_of(ours.path);
  return {{"cpu_s", ours.cpu_s},
          {"setup_s", ours.setup_s},
          {"stages_s", stages_of(ours)},
          {"newton_steps", counts.newton},
          {"cg_iterations", counts.cg},
          {"factors_renewed", ours.path.factors},
          {"halvings", ours.path.halvings},
          {"levels_reached", ours.path.steps.size()}};
}

// Progress of all runs of CalculiX together.
class Runs {
 public:
  explicit Runs(double total) : total_(total) {}
  // Begins a run that counts as `share` of the total.
  [[nodiscard]] Progress next(double share, const std::string& what) {
    begun_ += share_;
    share_ = share;
    total_ = std::max(total_, begun_ + share);
    return [this, what](const ProgressReport& r) {
      bar_.show({.task = "CalculiX",
                 .done = begun_ + share_ * r.done / r.total,
                 .total = total_,
                 .note = fmt::format("{}: {}", what, r.note)});
    };
  }
  void finish() { bar_.finish(); }

 private:
  ProgressBar bar_;
  double total_, begun_ = 0, share_ = 0;
};

// Results of both programs on one path, and their difference.
struct Pair {
  OurPath ours;
  CalculixRun theirs;
  PathDifference difference;
  double share = 1;  // ratio to the requested load
};
Pair solve_both(const SolidModel& model, const Matrix3Xd& full_load,
                const std::vector<double>& levels, const BenchSolidOptions& options,
                double share_of_runs, const std::string& what, Runs& runs) {
  Pair pair;
  Matrix3Xd load = full_load;
  // Repeated with a smaller load if one of the programs does not reach the end.
  for (int attempt = 0;; ++attempt) {
    pair.ours = solve_ours(model, load, levels, options.repeats);
    pair.theirs = {};
    double last = pair.ours.path.complete        ? 1.0
                  : pair.ours.path.steps.empty() ? 0.0
                                                 : pair.ours.path.steps.back().level;
    if (!options.ours_only) {
      pair.theirs = solve_with_calculix(
          model, load, levels, {.program = options.program, .tolerance = kTolerance, .folder = {}},
          runs.next(share_of_runs, what));
      if (!pair.theirs.complete) last = std::min(last, pair.theirs.last_level);
    }
    const bool complete = pair.ours.path.complete && (options.ours_only || pair.theirs.complete);
    if (complete) break;
    if (attempt == 2 || !(last > 0.0)) {
      throw Error(fmt::format("{}: no load that both programs reach: ours: {}; {}", what,
                              pair.ours.path.why_stopped, pair.theirs.why_stopped));
    }
    load *= kShareOfLast * last;
    pair.share *= kShareOfLast * last;
  }
  if (!options.ours_only) pair.difference = compare_paths(model, pair.ours.path, pair.theirs);
  return pair;
}

Json path_json(const Pair& pair, const BenchSolidOptions& options) {
  Json row = path_json(pair.ours);
  row["load_share"] = pair.share;
  if (options.ours_only) return row;
  row["ccx_cpu_s"] = pair.theirs.cpu_seconds;
  row["ccx_wall_s"] = pair.theirs.wall_seconds;
  row["ccx_increments"] = pair.theirs.increments;
  row["ccx_iterations"] = pair.theirs.iterations;
  row["ratio_to_ccx"] = pair.theirs.cpu_seconds / pair.ours.cpu_s;
  row["max_rel_difference_u"] = pair.difference.displacement;
  row["max_rel_difference_stress"] = pair.difference.stress;
  row["largest_displacement_m"] = pair.difference.largest_displacement;
  row["smallest_volume_ratio"] = pair.difference.smallest_volume_ratio;
  return row;
}

// Lower bound of the time of one path on this machine, for any method that makes one factor and,
// for each level, evaluates the forces once, multiplies by the tangent once and applies the factor
// once. Bytes are counted at the rate of a copy between arrays as large as the factor, operations
// at the rate of single-precision multiply-adds in registers; without overlap and without caching.
Json path_floor(const TetMesh& mesh, const SolverSetup& setup, int levels) {
  const MachineRates rates = measure_machine(static_cast<std::size_t>(setup.factor_bytes));
  // Displacements read, forces written and read: 3 doubles per node each.
  const double element_bytes = setup.element_bytes + 72.0 * mesh.node_count();
  // At each point, F and the forces take 18 multiply-adds per node, and the material law
  // about 100 operations.
  const double points = mesh.is_quadratic() ? 4 : 1, nodes = mesh.is_quadratic() ? 10 : 4;
  const double element_flops = mesh.tet_count() * points * (36.0 * nodes + 100.0);
  const double pass =
      std::max(element_bytes / rates.bytes_per_s, element_flops / rates.flops_per_s);
  const double application = 2.0 * setup.factor_bytes / rates.bytes_per_s;
  const double factor = setup.factor_flops / rates.flops_per_s;
  return {{"copy_bytes_per_s", rates.bytes_per_s},
          {"flops_per_s", rates.flops_per_s},
          {"vectors", rates.vectors},
          {"element_pass_bytes", element_bytes},
          {"element_pass_flops", element_flops},
          {"element_pass_s", pass},
          {"factor_bytes", setup.factor_bytes},
          {"factor_application_s", application},
          {"factor_flops", setup.factor_flops},
          {"factor_s", factor},
          {"path_s", factor + levels * (2.0 * pass + application)}};
}

Json at_json(const Vector3d& at) { return {at[0], at[1], at[2]}; }

// A description of the body with 10-node tetrahedra and about as many nodes, to be pressed at the
// same positions. With twice the edge length it has the same patches, because the midpoints of its
// edges are vertices of its skin.
BodyDescription of_ten_nodes(const BodyDescription& description,
                             const std::vector<Vector3d>& places) {
  BodyDescription coarse = description;
  coarse.shape.edge = 2.0 * *description.shape.edge;
  coarse.shape.order = 2;
  coarse.sites.count = 0;
  coarse.sites.at = {Where{Where::Nearest{places}, "the bench"}};
  return coarse;
}

Json ten_node_figures(const BodyProblem& problem, const std::vector<double>& levels, int repeats) {
  const EquilibriumSolver solver(problem.model, {.tolerance = kTolerance});
  Json rows = Json::array();
  std::vector<double> cpu;
  for (const Site& site : problem.sites) {
    const Matrix3Xd unit = unit_load(site, problem.mesh.boundary, problem.model.mesh.node_count());
    const LoadSearch search = solver.find_load(unit, problem.press);
    const double share = search.reached ? 1.0 : kShareOfLast;
    const OurPath ours = solve_ours(problem.model, share * search.load * unit, levels, repeats);
    if (!ours.path.complete) throw Error("10-node tetrahedra: " + ours.path.why_stopped);
    Json row = {{"at_m", at_json(problem.mesh.boundary.surface.vertices.col(site.vertex))},
                {"press_fraction", unit.cwiseProduct(ours.path.steps.back().displacement).sum() /
                                       problem.mesh.height}};
    row.update(path_json(ours));
    cpu.push_back(ours.cpu_s);
    rows.push_back(std::move(row));
  }
  return {{"nodes", problem.model.mesh.node_count()},
          {"tets", problem.model.mesh.tet_count()},
          {"path_cpu_s", median(cpu)},
          {"sites", std::move(rows)}};
}

// The paper's beam in its original size, with the St. Venant-Kirchhoff law: its tip is displaced by
// a fifth of its length.
struct Beam {
  SolidModel model;
  Matrix3Xd load;
};
Beam full_size_beam() {
  const Vector3d size(0.40, 0.10, 0.05);
  const double young = 0.5e6;
  Beam beam;
  beam.model.mesh = box_tets({0, 0, 0}, size, 56, 14, 8);
  beam.model.material = material_from_young("saint-venant-kirchhoff", young, 0.3);
  std::vector<int> tip;
  for (int n = 0; n < beam.model.mesh.node_count(); ++n) {
    if (beam.model.mesh.nodes(0, n) == 0.0) beam.model.fixed_nodes.push_back(n);
    if (beam.model.mesh.nodes(0, n) > size[0] - 1e-9) tip.push_back(n);
  }
  const double stiffness =
      3.0 * young * size[1] * std::pow(size[2], 3) / 12.0 / std::pow(size[0], 3);
  beam.load = 0.2 * size[0] * stiffness *
              patch_force(beam.model.mesh.node_count(), tip, std::vector<double>(tip.size(), 1.0),
                          {0.05, 0.2, -1.0});
  return beam;
}

// The body with the properties that this benchmark needs: one material that CalculiX has, and an
// edge length that can be doubled.
BodyDescription described(const BenchSolidOptions& options) {
  BodyDescription description = read_body_description(options.description);
  if (!description.shape.edge || !description.material.constants.empty()) {
    throw Error(
        fmt::format("{}: the bench needs an edge in [shape], because it meshes the body "
                    "with twice that edge, too, and a material by young and poisson",
                    options.description));
  }
  description.material.law = options.law;
  description.shape.order = 1;
  return description;
}

BodyProblem posed(const BodyDescription& description, const BenchSolidOptions& options) {
  BodyProblem problem = pose_body(description);
  if (problem.preload.cols() > 0 || problem.force > 0.0 || !problem.model.groups.empty()) {
    throw Error(
        fmt::format("{}: the bench presses a body of one material by a depth, without "
                    "weight and pressures",
                    options.description));
  }
  for (const int number : options.sites) {
    if (number < static_cast<int>(problem.sites.size())) continue;
    throw Error(
        fmt::format("there is no site {}; the body has 0 to {}", number, problem.sites.size() - 1));
  }
  return problem;
}

// The largest differences between both programs, and the paths on which they exceed the limits.
struct Differences {
  double displacement = 0, stress = 0;
  std::vector<std::string> beyond;

  void add(const std::string& what, const PathDifference& difference) {
    displacement = std::max(displacement, difference.displacement);
    stress = std::max(stress, difference.stress);
    if (difference.displacement <= kDisplacementLimit && difference.stress <= kStressLimit) return;
    beyond.push_back(fmt::format("{}: displacement {:.1e} (bar {:.0e}), stress {:.1e} (bar {:.0e})",
                                 what, difference.displacement, kDisplacementLimit,
                                 difference.stress, kStressLimit));
  }
};

struct SitePaths {
  Json sites = Json::array(), floor;
  std::vector<Vector3d> places;
  std::vector<double> cpu, ccx_cpu, ratios, fractions;  // one value per site
};

SitePaths press_sites(const BodyProblem& problem, const std::vector<double>& levels,
                      const BenchSolidOptions& options, Runs& runs, Differences& differences) {
  const TetMesh& mesh = problem.model.mesh;
  const EquilibriumSolver search_solver(problem.model, {.tolerance = kTolerance});
  SitePaths paths;
  for (const int number : options.sites) {
    const Site& site = problem.sites[number];
    const std::string what = fmt::format("site {}", number);
    const Matrix3Xd unit = unit_load(site, problem.mesh.boundary, mesh.node_count());
    const LoadSearch search = search_solver.find_load(unit, problem.press);
    if (!(search.load > 0.0)) throw Error(what + " cannot be pressed: " + search.why_stopped);
    const double first_share = search.reached ? 1.0 : kShareOfLast;
    Pair pair = solve_both(problem.model, first_share * search.load * unit, levels, options, 1.0,
                           what, runs);
    pair.share *= first_share;
    const double press =
        unit.cwiseProduct(pair.ours.path.steps.back().displacement).sum() / problem.mesh.height;
    paths.places.emplace_back(problem.mesh.boundary.surface.vertices.col(site.vertex));
    Json row = {
        {"site", number}, {"at_m", at_json(paths.places.back())}, {"press_fraction", press}};
    row.update(path_json(pair, options));
    paths.sites.push_back(std::move(row));
    paths.cpu.push_back(pair.ours.cpu_s);
    if (paths.floor.is_null()) paths.floor = path_floor(mesh, pair.ours.setup, options.levels);
    paths.ccx_cpu.push_back(pair.theirs.cpu_seconds);
    paths.ratios.push_back(pair.theirs.cpu_seconds / pair.ours.cpu_s);
    paths.fractions.push_back(press);
    if (!options.ours_only) differences.add(what, pair.difference);
  }
  return paths;
}

// Compares both programs on the paper's beam and on 10-node tetrahedra.
Json verify_others(const BodyProblem& ten, const BenchSolidOptions& options, Runs& runs,
                   Differences& differences) {
  Json verified = Json::array();
  const auto verify = [&](const std::string& what, const SolidModel& model, const Matrix3Xd& load,
                          int count, double share) {
    BenchSolidOptions once = options;
    once.repeats = 1;
    const Pair pair = solve_both(model, load, even_levels(count), once, share, what, runs);
    differences.add(what, pair.difference);
    Json row = {{"body", what},
                {"law", law_name(model.material)},
                {"nodes", model.mesh.node_count()},
                {"tets", model.mesh.tet_count()},
                {"element", model.mesh.is_quadratic() ? "C3D10" : "C3D4"},
                {"levels", count}};
    row.update(path_json(pair, once));
    verified.push_back(std::move(row));
  };
  const Beam beam = full_size_beam();
  verify("beam", beam.model, beam.load, 10, 0.3);
  const Matrix3Xd unit =
      unit_load(ten.sites.front(), ten.mesh.boundary, ten.model.mesh.node_count());
  const LoadSearch search =
      EquilibriumSolver(ten.model, {.tolerance = kTolerance}).find_load(unit, 0.5 * ten.press);
  if (!search.reached) throw Error("the 10-node body cannot be pressed: " + search.why_stopped);
  verify("bunny, 10-node tetrahedra", ten.model, search.load * unit, 5, 1.2);
  return verified;
}

Json solid_figures(const BodyDescription& description, const BodyProblem& problem,
                   const BenchSolidOptions& options, SitePaths paths,
                   const Differences& differences) {
  Json result;
  result["title"] = "An equilibrium path against CalculiX";
  result["order"] = 40;
  result["date"] = date_today();
  result["machine"] = processor_name();
  result["command"] =
      fmt::format("palpable bench solid {} --sites {} --levels {}{} --json", options.description,
                  fmt::join(options.sites, " "), options.levels, options.verify ? " --verify" : "");
  result["body"] = description.name;
  result["law"] = options.law;
  result["young_Pa"] = description.material.young;
  result["poisson"] = description.material.poisson;
  result["nodes"] = problem.model.mesh.node_count();
  result["tets"] = problem.model.mesh.tet_count();
  result["skin_vertices"] = problem.mesh.boundary.surface.vertex_count();
  result["levels"] = options.levels;
  result["residual"] = kTolerance;
  result["press_fraction"] = *std::min_element(paths.fractions.begin(), paths.fractions.end());
  result["path_cpu_s"] = median(paths.cpu);
  if (!options.ours_only) {
    result["ccx_cpu_s"] = median(paths.ccx_cpu);
    result["ratio_to_ccx"] = median(paths.ratios);
    result["max_rel_difference_u"] = differences.displacement;
    result["max_rel_difference_stress"] = differences.stress;
  }
  result["floor_s"] = paths.floor["path_s"];
  result["memory_bytes"] = peak_memory();
  result["floor"] = std::move(paths.floor);
  result["sites"] = std::move(paths.sites);
  return result;
}

void bench_solid(const BenchSolidOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  if (!options.ours_only && !find_calculix(options.program)) {
    throw Error(
        fmt::format("CalculiX ({}) is not there or cannot be run; on Debian: apt install "
                    "calculix-ccx, or ask for --ours-only",
                    options.program));
  }
  const BodyDescription description = described(options);
  const BodyProblem problem = posed(description, options);
  const std::vector<double> levels = even_levels(options.levels);
  Runs runs((options.verify ? 1.5 : 1.0) * static_cast<double>(options.sites.size()));
  Differences differences;
  SitePaths paths = press_sites(problem, levels, options, runs, differences);
  const std::vector<Vector3d> places = paths.places;
  Json result = solid_figures(description, problem, options, std::move(paths), differences);
  const BodyProblem ten = pose_body(of_ten_nodes(description, places));
  result["ten_node"] = ten_node_figures(ten, levels, options.repeats);
  if (options.verify && !options.ours_only) {
    result["verified"] = verify_others(ten, options, runs, differences);
    result["max_rel_difference_u"] = differences.displacement;
    result["max_rel_difference_stress"] = differences.stress;
  }
  result["text"] = solid_section_text(result, options.law, options.levels, kTolerance);
  result["tables"] = solid_section_tables(result);
  runs.finish();
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  result["wall_s"] = wall.count();
  if (options.json) {
    fmt::print("{}\n", result.dump(1));
  } else {
    for (const auto& [key, value] : result.items()) fmt::print("{:<26} {}\n", key, value.dump());
  }
  if (options.verify && !differences.beyond.empty()) {
    throw Error(fmt::format("the programs differ by more than they may: {}",
                            fmt::join(differences.beyond, "; ")));
  }
}

}  // namespace

void add_bench_solid(Command bench) {
  const auto options = std::make_shared<BenchSolidOptions>();
  Command command = bench.add_subcommand(
      "solid", "One equilibrium path against CalculiX' in CPU time, and digit by digit");
  command.add_option("body", options->description, "The body, with an edge in [shape]")
      .type_name("FILE.toml")
      .show_default();
  command.add_option("--law", options->law, "The body's law here: one that CalculiX has, too")
      .show_default();
  command.add_option("--sites", options->sites, "Which of the body's sites, from 0")
      .not_negative()
      .show_default();
  command.add_option("--levels", options->levels, "Load levels of a path")
      .in_range(1, 1000)
      .show_default();
  command
      .add_option("--repeats", options->repeats, "How often our path is timed; the median counts")
      .in_range(1, 100)
      .show_default();
  command.add_option("--ccx", options->program, "CalculiX' program").show_default();
  command.add_flag("--verify", options->verify,
                   "A beam and 10-node tetrahedra, too; exit code 1 if displacements differ by "
                   "more than 1e-6 of the largest or stresses by more than 1e-5");
  command.add_flag("--ours-only", options->ours_only, "Leave CalculiX out: takes a minute");
  command.add_json(options->json);
  command.footer(
      "CalculiX takes about 5 minutes for each site of the paper's bunny.\n"
      "Example: palpable bench solid --json");
  command.callback([options] { bench_solid(*options); });
}

}  // namespace palpable::app
