#include "palpable/bake/pipeline/baked_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace palpable {
namespace {

// The errors of sparse PGD on the snapshots that it did not learn from.
std::string unseen_text(const ReductionReport& report) {
  if (!report.learning) return {};
  const SnapshotErrors& unseen = report.learning->unseen;
  return fmt::format(
      "; learnt from {} snapshots, of the {} others {:.2g} pooled, {:.2g} at the worst",
      report.learning->trained_on, unseen.count, unseen.pooled, unseen.worst);
}

std::string text_of(const char* what, const ReductionReport& report, double rounding) {
  return fmt::format(
      "{}: {}, {} modes{}, error {:.2g} pooled, {:.2g} at the worst snapshot{}{}{}\n", what,
      report.method, report.modes,
      report.method == method_name(ReductionMethod::kPerSite)
          ? fmt::format(" at most, {} in all", report.columns)
          : std::string(),
      report.pooled, report.worst, unseen_text(report),
      rounding > 0.0 ? fmt::format("; stored in half precision, which adds {:.1e}", rounding)
                     : std::string(),
      report.reached ? "" : " (the tolerance was not reached: raise max_modes)");
}

// The error against the number of modes, both fields side by side, in about ten rows and those of 1
// and of all modes; an empty line where it is not known.
std::string errors_text(const BakeReport& report) {
  const Eigen::VectorXd& u = report.displacement.errors;
  const Eigen::VectorXd& sigma = report.stress.errors;
  const Eigen::Index most = std::max(u.size(), sigma.size());
  if (most == 0) return "\n";
  std::set<Eigen::Index> rows{1, u.size(), sigma.size()};
  const Eigen::Index step = std::max<Eigen::Index>(1, most / 10);
  for (Eigen::Index m = step; m <= most; m += step) rows.insert(m);
  rows.erase(0);  // from a field that has no modes
  const auto cell = [](const Eigen::VectorXd& errors, Eigen::Index m) {
    return m <= errors.size() ? fmt::format("{:.2e}", errors[m - 1]) : std::string("-");
  };
  std::string text =
      fmt::format("\nrelative error against the number of modes\n{:>6} {:>14} {:>10}\n", "modes",
                  "displacement", "stress");
  for (const Eigen::Index m : rows)
    text += fmt::format("{:>6} {:>14} {:>10}\n", m, cell(u, m), cell(sigma, m));
  return text + "\n";
}

}  // namespace

std::string text_of(const BakedBody& baked) {
  const BakeReport& report = baked.report;
  std::string text = errors_text(report);
  for (std::size_t s = 0; s < report.outcomes.size(); ++s) {
    const SiteOutcome& outcome = report.outcomes[s];
    if (outcome.reached_press) continue;
    text += fmt::format("site {}: pressed {:.3g} m in only, by {:.3g} N: {}\n", s, outcome.press,
                        baked.body.sites[s].full_load, outcome.shortfall);
  }
  const auto reached = std::count_if(report.outcomes.begin(), report.outcomes.end(),
                                     [](const SiteOutcome& o) { return o.reached_press; });
  text += fmt::format("{} nodes, {} tetrahedra; {} sites x {} levels, {} reach the press\n",
                      report.nodes, report.tets, baked.body.sites.size(),
                      baked.body.levels().size() - 1, reached);
  const ReductionError& error = baked.body.error;
  text += text_of("displacement", report.displacement, error.displacement_rounding);
  text += text_of("stress", report.stress, error.stress_rounding);
  if (const auto& volume = baked.body.volume) {
    text +=
        fmt::format("inside: {} nodes, {} tetrahedra\n", volume->nodes.cols(), volume->tets.cols());
  }
  if (!report.between_sites.empty())
    text += fmt::format("between sites: {}\n", report.between_sites);
  if (!report.held_out.empty()) text += fmt::format("held out: {}\n", report.held_out);
  return text;
}

}  // namespace palpable
