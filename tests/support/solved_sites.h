/// @file
/// All sites of a body solved into memory, for tests that look at the numbers.
#pragma once

#include "palpable/bake/site_run.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable::test {

struct SolvedSites {
  std::vector<Site> sites;       ///< with full_load found
  Eigen::MatrixXd displacement;  ///< (3N x S L) m, level fastest
  Eigen::MatrixXd stress;        ///< (6N x S L) Pa
  Eigen::MatrixXd press_depth;   ///< (L + 1 x S) m
  std::vector<SiteOutcome> outcomes;
  double largest_von_mises = 0;
  Eigen::Matrix3Xd rest;
};

inline SolvedSites solved_sites(const EquilibriumSolver& solver, const Boundary& boundary,
                                std::vector<Site> sites, const SiteRunSettings& settings,
                                const Eigen::Matrix3Xd& preload = Eigen::Matrix3Xd(3, 0)) {
  const SiteSolver presses(solver, boundary, preload);
  const std::vector<int> batches = site_batches(static_cast<int>(sites.size()));
  const Eigen::Index N = solver.model().mesh.node_count(), L = settings.levels;
  const auto S = static_cast<Eigen::Index>(sites.size());
  SolvedSites all;
  all.rest = presses.rest();
  all.displacement.resize(3 * N, S * L);
  all.stress.resize(6 * N, S * L);
  all.press_depth.resize(L + 1, S);
  for (std::size_t b = 0; b + 1 < batches.size(); ++b) {
    StageTimes times;
    const int first = batches[b], count = batches[b + 1] - batches[b];
    const std::span<const Site> batch(&sites[static_cast<std::size_t>(first)],
                                      static_cast<std::size_t>(count));
    Eigen::Index s = first;
    for (const SiteSnapshots& site : solve_sites(presses, batch, first, settings, times)) {
      all.displacement.middleCols(s * L, L) = site.displacement.cast<double>();
      all.stress.middleCols(s * L, L) = site.stress.cast<double>();
      all.press_depth.col(s) = site.press_depth;
      all.outcomes.push_back(site.outcome);
      all.largest_von_mises = std::max(all.largest_von_mises, site.largest_von_mises);
      sites[static_cast<std::size_t>(s++)].full_load = site.full_load;
    }
  }
  all.sites = std::move(sites);
  return all;
}

}  // namespace palpable::test
