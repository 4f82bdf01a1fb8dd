// palpable bench beam: compares the beam by intrusive PGD with the SVD of its own fields, with
// held-out positions, with full-order solutions and with the linear model.

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "palpable/bake/intrusive/intrusive_bake.h"
#include "palpable/bake/intrusive/linear_pgd.h"
#include "palpable/common/base/cpu_time.h"
#include "palpable/common/base/json.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/output_name.h"
#include "palpable/common/body_file/body_file.h"

#include "bench/bake/beam_study.h"
#include "bench/bake/bench.h"
#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

struct BenchBeamOptions {
  std::string description = "bodies/beam.toml";
  std::string output = "build/bench-beam.palpable";
  std::string against;
  unsigned seed = 1;
  int checks = 20;
  bool json = false;
};

// The smallest number of modes with this tolerance; null if all of them do not suffice.
Json modes_at(const Eigen::VectorXd& errors, double tolerance) {
  const auto met =
      std::find_if(errors.begin(), errors.end(), [&](double e) { return e <= tolerance; });
  return met == errors.end() ? Json() : Json(met - errors.begin() + 1);
}

// CPU time of an evaluation, us: median over many evaluations with changing loads.
double evaluation_us(const SeparatedField& field, int sites) {
  std::vector<float> values(field.value_count());
  std::vector<double> times;
  for (int k = 0; k < 2000; ++k) {
    const std::array<double, 2> mu{static_cast<double>((37 * k) % sites), 0.05 + 0.0004 * k};
    const double begin = thread_cpu_seconds();
    field.evaluate(mu, values);
    times.push_back(1e6 * (thread_cpu_seconds() - begin));
  }
  return upper_median(times);
}

// Both variants of the linear PGD, each in both norms.
Json linear_figures(const IntrusiveBake& made) {
  Json result;
  constexpr int kModes = 16;
  for (const auto& [name, step] : {std::pair{"adjoint", PositionStep::kAdjoint},
                                   std::pair{"galerkin", PositionStep::kGalerkin}}) {
    const double begin = process_cpu_seconds();
    const LinearPgd pgd =
        linear_pgd(made.series, made.travelling.load, made.travelling.area, step, kModes);
    const double seconds = process_cpu_seconds() - begin;
    const LinearErrors errors =
        linear_errors(made.series, made.travelling.load, made.travelling.area, pgd);
    result[name] = {{"modes_at_1e-2", modes_at(errors.l2, 1e-2)},
                    {"modes_at_1e-3", modes_at(errors.l2, 1e-3)},
                    {"l2_with_16", errors.l2[kModes - 1]},
                    {"energy_with_16", errors.energy[kModes - 1]},
                    {"solves", pgd.solves},
                    {"cpu_s", seconds}};
  }
  return result;
}

Json series_figures(const SeriesTable& table) {
  return {
      {"orders_most", table.most_orders},
      {"orders_mean", static_cast<double>(table.orders) / static_cast<double>(table.positions())},
      {"force_residual", table.worst_residual.maxCoeff()},
      {"force_residual_at_loads",
       std::vector<double>(table.worst_residual.begin(), table.worst_residual.end())},
      {"pade_gap", table.worst_pade_gap}};
}

// Numbers of modes of the greedy PGD, of the recompressed PGD, and of the SVD of the same fields.
Json modes_figures(const IntrusiveBake& made, const Progress& progress) {
  const SeriesPgdGoal plain{.weight = SeriesWeight::kPlain, .modes = 18, .tolerance = 6e-4};
  const SeriesPgd raw = series_pgd(made.series, made.table, plain, progress);
  const SeriesPgd best = recompressed(raw, made.table, plain, static_cast<int>(raw.F.cols()));
  const SeriesPgd svd = svd_of_series(made.series, made.table, plain, progress);
  return {{"raw", modes_at(raw.errors, 1e-3)},
          {"recompressed", modes_at(best.errors, 1e-3)},
          {"svd", modes_at(svd.errors, 1e-3)}};
}

void add_held_out(const IntrusiveBake& made, const Progress& progress, Json& result) {
  const HeldOutPositions held_out =
      held_out_positions(made.series, made.travelling, made.table, 64, progress);
  result["heldout_positions"] = held_out.held_out;
  result["heldout_trained_on"] = held_out.trained_on;
  result["heldout_modes"] = held_out.modes;
  result["heldout_position_global"] = held_out.global;
  result["heldout_position_worst"] = held_out.worst;
}

// The errors as the bake stated them, with deflections, steps and times in addition.
void add_two_loads(const IntrusiveBake& made, Json& result) {
  if (!made.body.several) return;
  std::vector<double> steps, ms, deflections;
  for (const TwoLoadCheck& check : made.two_loads) {
    steps.push_back(check.steps);
    ms.push_back(check.ms);
    deflections.push_back(check.deflection);
  }
  result["two_load_error"] = made.body.several->error_worst;
  result["two_load_error_median"] = made.body.several->error_median;
  result["two_load_pairs"] = made.two_loads.size();
  result["two_load_modes"] = made.body.several->mode_count();
  result["two_load_largest_deflection_m"] =
      *std::max_element(deflections.begin(), deflections.end());
  result["two_load_steps_most"] = *std::max_element(steps.begin(), steps.end());
  result["two_load_ms_median"] = upper_median(ms);
}

Json newton_figures(const IntrusiveBake& made, const BenchBeamOptions& options,
                    const Progress& progress) {
  std::vector<double> u, sigma, deflection;
  for (const NewtonCheck& check : newton_checks(made, options.checks, options.seed, progress)) {
    u.push_back(check.displacement);
    sigma.push_back(check.stress);
    deflection.push_back(check.deflection);
  }
  return {{"solves", u.size()},
          {"seed", options.seed},
          {"largest_deflection_m", *std::max_element(deflection.begin(), deflection.end())},
          {"displacement_median", upper_median(u)},
          {"displacement_worst", *std::max_element(u.begin(), u.end())},
          {"stress_median", upper_median(sigma)},
          {"stress_worst", *std::max_element(sigma.begin(), sigma.end())}};
}

Json difference_figures(const ReducedBody& body, const std::string& against) {
  const ReducedBody other = value_or_throw(read_pressable_body(against));
  const BodyDifference d = body_difference(body, other);
  return {{"body", against},
          {"shared_sites", d.shared},
          {"displacement_pooled", d.displacement_pooled},
          {"displacement_median", d.displacement_median},
          {"displacement_worst", d.displacement_worst},
          {"stress_pooled", d.stress_pooled},
          {"stress_median", d.stress_median},
          {"stress_worst", d.stress_worst},
          {"own_errors_of_it",
           {{"displacement_pooled", other.error.displacement_pooled},
            {"displacement_worst", other.error.displacement_worst},
            {"stress_pooled", other.error.stress_pooled},
            {"stress_worst", other.error.stress_worst}}}};
}

void bench_beam(const BenchBeamOptions& options) {
  const BodyDescription description = read_body_description(options.description);
  guard_output_file(options.output, {options.description, description.shape.file, options.against});
  require_ending(options.output, {kBodyFileEnding}, "a body file");
  ProgressBar bar;
  const double begin = process_cpu_seconds();
  const IntrusiveBake made = bake_intrusive(
      description, {.checks = options.checks, .seed = options.seed, .all_residuals = true},
      bar.progress());
  write_body_file(options.output, made.body);
  const double offline = process_cpu_seconds() - begin - 1e-3 * made.report.cpu.ms("references");

  Json result;
  result["bench"] = "beam";
  result["body"] = options.description;
  result["nodes"] = made.series.model().mesh.node_count();
  result["positions"] = made.table.positions();
  result["offline_cpu_s"] = offline;
  for (const StageTime& stage : made.report.cpu.stages()) {
    result["offline_parts_cpu_s"][std::string(stage.name)] = 1e-3 * stage.ms;
  }
  result["series"] = series_figures(made.table);
  result["modes_at_1e-3"] = modes_figures(made, bar.progress());
  result["modes_used"] = made.report.modes;
  result["products_used"] = made.report.columns;
  result["global"] = made.report.displacement.global;
  result["worst_of_own_norm"] = made.report.displacement.worst;
  add_held_out(made, bar.progress(), result);
  result["linear_model_worst"] = linear_model_error(made.table);
  result["linear"] = linear_figures(made);
  add_two_loads(made, result);
  result["newton"] = newton_figures(made, options, bar.progress());
  bar.finish();
  result["stress"] = {{"modes", made.report.stress_modes},
                      {"products", made.report.stress_columns},
                      {"pooled", made.report.stress_pooled},
                      {"worst_of_own_norm", made.report.stress_worst}};
  if (!options.against.empty()) {
    result["against"] = difference_figures(made.body, options.against);
  }
  const int sites = static_cast<int>(made.body.sites.size());
  result["online_us"] = evaluation_us(made.body.displacement, sites);
  result["online_stress_us"] = evaluation_us(made.body.stress, sites);
  result["file_bytes"] = std::filesystem::file_size(options.output);
  print_figures(std::move(result), options.json);
}

}  // namespace

void add_bench_beam(Command bench) {
  const auto options = std::make_shared<BenchBeamOptions>();
  Command command = bench.add_subcommand(
      "beam", "The beam by intrusive PGD: modes, positions left out, fresh Newton solves");
  command.add_option("body", options->description, "A body with a section [intrusive]")
      .type_name("FILE.toml")
      .show_default();
  command.add_option("-o,--out", options->output, "Body file to write")
      .type_name("FILE")
      .show_default();
  command
      .add_option("--seed", options->seed, "Decides the positions and loads that are solved afresh")
      .show_default();
  command.add_option("--checks", options->checks, "How many are solved afresh")
      .in_range(1, 1000)
      .show_default();
  command
      .add_option("--against", options->against,
                  "A body of the same mesh made by a campaign: how far the two are apart at the "
                  "sites that both have")
      .type_name("FILE");
  command.add_json(options->json);
  command.footer("Takes 10 minutes of CPU and 3 GB.\nExample: palpable-bake bench beam --json");
  command.callback([options] { bench_beam(*options); });
}

}  // namespace palpable::app
