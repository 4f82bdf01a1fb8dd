/// @file
/// All sites of a body solved in memory, for tests of the numbers.
#pragma once

#include "palpable/bake/campaign/site_run.h"

#include <Eigen/Core>

#include <algorithm>
#include <optional>
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
  const Eigen::Index N = solver.model().mesh.node_count(), L = settings.levels;
  const auto S = static_cast<Eigen::Index>(sites.size());
  SolvedSites all;
  all.rest = presses.rest();
  all.displacement.resize(3 * N, S * L);
  all.stress.resize(6 * N, S * L);
  all.press_depth.resize(L + 1, S);
  all.outcomes.resize(sites.size());
  int next = 0;
  const SiteStream stream{
      [&]() -> std::optional<int> { return next < S ? std::optional(next++) : std::nullopt; },
      [](int, double) {},
      [&](int at, const SiteSnapshots& site, const StageTimes&) {
        const Eigen::Index s = at;
        all.displacement.middleCols(s * L, L) = site.displacement.cast<double>();
        all.stress.middleCols(s * L, L) = site.stress.cast<double>();
        all.press_depth.col(s) = site.press_depth;
        all.outcomes[s] = site.outcome;
        all.largest_von_mises = std::max(all.largest_von_mises, site.largest_von_mises);
        sites[s].full_load = site.full_load;
      }};
  const std::vector<Site> as_given = sites;
  solve_sites(presses, as_given, settings, 1, stream);
  all.sites = std::move(sites);
  return all;
}

}  // namespace palpable::test
