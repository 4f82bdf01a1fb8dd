/// @file
/// Computes the snapshots of a campaign by CalculiX instead of our solver, from the same input.
#pragma once

#include "palpable/bake/campaign/site_run.h"

#include <functional>
#include <span>
#include <string>

namespace palpable {

/// Our solver finds the load of each site, because CalculiX has no search for a load; `ccx`
/// computes the path, in one process per site. Nodal stress is recovered from CalculiX'
/// displacements in the same way as from ours, so that both kinds of snapshots can be compared. ccx
/// prints seven digits of each displacement.
class CalculixSites {
 public:
  /// @param solver   outlives this
  /// @param program  a name on PATH, or a path
  /// @throws Error when the program is not there, or there is a preload: decks have no load that
  ///         stays while another one grows
  CalculixSites(const SiteSolver& solver, std::string program);

  /// As solve_sites(). Where ccx refuses a deck, the Error holds ccx's message.
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
