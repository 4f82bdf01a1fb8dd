// palpable bake BODY.toml -o bunny.palpable

#include "apps/common/progress_bar.h"
#include "apps/palpable-bake/commands.h"
#include "palpable/bake/bake_body.h"
#include "palpable/base/error.h"
#include "palpable/reduced/body_file.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <set>
#include <string>

namespace palpable::app {
namespace {

struct Options {
  std::string description;
  std::string output;
  int threads = 0;
};

void print_reduction(const char* what, const ReductionReport& report) {
  fmt::print("{}: {} modes, error {:.2g} pooled, {:.2g} at the worst snapshot{}\n", what,
             report.errors.size(), report.pooled, report.worst,
             report.reached ? "" : " (the tolerance was not reached: raise max_modes)");
}

// The error against the number of modes, both fields side by side, in about ten rows and the ends.
void print_errors(const BakeReport& report) {
  const Eigen::VectorXd& u = report.displacement.errors;
  const Eigen::VectorXd& sigma = report.stress.errors;
  const Eigen::Index most = std::max(u.size(), sigma.size());
  std::set<Eigen::Index> rows{1, u.size(), sigma.size()};
  const Eigen::Index step = std::max<Eigen::Index>(1, most / 10);
  for (Eigen::Index m = step; m <= most; m += step) rows.insert(m);
  const auto cell = [](const Eigen::VectorXd& errors, Eigen::Index m) {
    return m <= errors.size() ? fmt::format("{:.2e}", errors[m - 1]) : std::string("-");
  };
  fmt::print("\nrelative error against the number of modes\n{:>6} {:>14} {:>10}\n", "modes",
             "displacement", "stress");
  for (const Eigen::Index m : rows)
    fmt::print("{:>6} {:>14} {:>10}\n", m, cell(u, m), cell(sigma, m));
  fmt::print("\n");
}

void bake(const Options& options, const std::string& command_line) {
  // Where to write is looked at before the work, not after it.
  const std::filesystem::path folder = std::filesystem::absolute(options.output).parent_path();
  if (!std::filesystem::is_directory(folder)) {
    throw Error(fmt::format("{}: the folder {} does not exist", options.output, folder.string()));
  }
  const auto begin = std::chrono::steady_clock::now();
  const BodyDescription description = read_body_description(options.description);
  ProgressBar bar;
  const BakedBody baked = bake_body(description,
                                    {.threads = options.threads,
                                     .version = std::string("palpable ") + PALPABLE_VERSION,
                                     .command_line = command_line},
                                    bar.progress());
  bar.finish();
  write_body_file(options.output, baked.body);

  const BakeReport& report = baked.report;
  print_errors(report);
  for (std::size_t s = 0; s < report.outcomes.size(); ++s) {
    const SiteOutcome& outcome = report.outcomes[s];
    if (outcome.reached_press) continue;
    fmt::print("site {}: pressed {:.3g} m in only: {}\n", s, outcome.press, outcome.shortfall);
  }
  const auto reached = std::count_if(report.outcomes.begin(), report.outcomes.end(),
                                     [](const SiteOutcome& o) { return o.reached_press; });
  fmt::print("{} nodes, {} tetrahedra; {} sites x {} levels, {} reach the press\n", report.nodes,
             report.tets, baked.body.sites.size(), baked.body.levels().size() - 1, reached);
  print_reduction("displacement", report.displacement);
  print_reduction("stress", report.stress);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  std::error_code code;
  fmt::print("{}: {:.1f} MB in {}; look at it with: palpable view {}\n", options.output,
             static_cast<double>(std::filesystem::file_size(options.output, code)) / 1e6,
             duration_text(taken.count()), options.output);
}

}  // namespace

void add_bake(CLI::App& app, const std::string& command_line) {
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("bake", "Mesh, solve and reduce: a body file from a description");
  command->add_option("body", options->description, "What to bake (docs/body.md)")
      ->required()
      ->type_name("BODY.toml");
  command->add_option("-o,--out", options->output, "Body file to write")
      ->required()
      ->type_name("FILE");
  command->add_option("--threads", options->threads, "Sites solved side by side; 0: one per core")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  command->footer("Example: palpable bake bodies/bunny-demo.toml -o bunny.palpable");
  command->callback([options, command_line] { bake(*options, command_line); });
}

}  // namespace palpable::app
