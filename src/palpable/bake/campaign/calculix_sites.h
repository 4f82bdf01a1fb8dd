/// @file
/// The work of a campaign done by CalculiX instead of our solver: same question, same answer.
#pragma once

#include "palpable/bake/campaign/site_run.h"

#include <functional>
#include <span>
#include <string>

namespace palpable {

/// Loads are found by our solver (CalculiX has no search for one), paths by `ccx`, one process per
/// site; stress at the nodes is recovered from CalculiX' displacement as from ours, so that both
/// kinds of snapshots mean the same. Seven digits of each displacement are all that ccx prints.
class CalculixSites {
 public:
  /// @param solver   outlives this
  /// @param program  a name on PATH, or a path
  /// @throws Error when the program is not there, or there is a preload: decks have no load that
  ///         stays while another one grows
  CalculixSites(const SiteSolver& solver, std::string program);

  /// As solve_sites(); the error of a deck that ccx refuses, or of a law that it does not have, is
  /// in its own words.
  void solve(std::span<const Site> sites, const SiteRunSettings& settings, int threads,
             const SiteStream& stream) const;

 private:
  [[nodiscard]] SiteSnapshots solve_site(const Site& place, const SiteRunSettings& settings,
                                         StageTimes& times,
                                         const std::function<void(double)>& tick) const;

  const SiteSolver& solver_;
  std::string program_;
};

}  // namespace palpable
