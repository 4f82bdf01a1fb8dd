#include "apps/palpable-bake/body_report.h"

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "palpable/base/error.h"
#include "palpable/base/this_machine.h"
#include "palpable/describe/body_mesh.h"
#include "palpable/describe/body_size.h"
#include "palpable/geometry/size_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <set>
#include <system_error>

namespace palpable::app {
namespace {

void print_reduction(const char* what, const ReductionReport& report, double rounding) {
  fmt::print("{}: {}, {} modes{}, error {:.2g} pooled, {:.2g} at the worst snapshot{}{}\n", what,
             method_name(report.method), report.modes,
             report.method == ReductionMethod::kPerSite
                 ? fmt::format(" at most, {} in all", report.columns)
                 : std::string(),
             report.pooled, report.worst,
             rounding > 0.0 ? fmt::format("; stored in half precision, which adds {:.1e}", rounding)
                            : std::string(),
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

}  // namespace

void add_file_options(Command command, FileOptions& options) {
  command.add_flag("--volume", options.volume,
                   "Keep all nodes and elements, which palpable export can write, not only the "
                   "boundary, which the live half draws");
  command.add_flag("--float16", options.float16,
                   "Keep modes in half precision: half the bytes; the loss is printed");
}

void print_size(const BodyDescription& description) {
  const Eigen::Vector3d size = size_of_body(description);
  fmt::print("{}: {}\n", description.name, size_text(size));
  std::fflush(stdout);  // before the progress bar
  if (const auto warning = size_warning(description.shape, size)) {
    fmt::print(stderr, "warning: {}\n", *warning);
  }
  if (const auto warning = wrap_warning(description.shape)) {
    fmt::print(stderr, "warning: {}\n", *warning);
  }
}

void print_body_report(const BakedBody& baked, const std::string& output, double seconds) {
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
  const ReductionError& error = baked.body.error;
  print_reduction("displacement", report.displacement, error.displacement_rounding);
  print_reduction("stress", report.stress, error.stress_rounding);
  if (const auto& volume = baked.body.volume) {
    fmt::print("inside: {} nodes, {} tetrahedra\n", volume->nodes.cols(), volume->tets.cols());
  }
  if (!report.between_sites.empty()) fmt::print("between sites: {}\n", report.between_sites);
  if (!report.held_out.empty()) fmt::print("held out: {}\n", report.held_out);
  std::error_code code;
  fmt::print(
      "{}: {:.1f} MB in {}, with at most {:.0f} MB of memory; look at it with: palpable view {}\n",
      output, static_cast<double>(std::filesystem::file_size(output, code)) / 1e6,
      duration_text(seconds), peak_memory() / 1e6, output);
}

std::map<std::string, double> parse_values(const std::vector<std::string>& texts) {
  return parse_settings(texts, "--at", "one of its values, such as ears=0.5");
}

}  // namespace palpable::app
