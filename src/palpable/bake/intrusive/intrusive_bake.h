/// @file
/// `bake --method intrusive-pgd`: a body under a load that travels, from its description to a body
/// file without a campaign (paper Sec. 5.1).
///
///   N  nodes   S  positions   J  load sizes
#pragma once

#include "palpable/bake/describe/body_description.h"
#include "palpable/bake/intrusive/series_pgd.h"
#include "palpable/bake/intrusive/series_table.h"
#include "palpable/bake/intrusive/travelling_load.h"
#include "palpable/bake/solid/load_series.h"
#include "palpable/common/base/progress.h"
#include "palpable/common/base/stage_clock.h"
#include "palpable/common/reduced/reduced_body.h"

#include <string>
#include <utility>
#include <vector>

namespace palpable {

struct IntrusiveSettings {
  std::string version = {}, command_line = {};  ///< for the provenance
  /// Pairs of loads that are solved afresh, so that the body file can say how far several loads at
  /// once are from that; their time is the stage "references".
  int checks = 6;
  unsigned seed = 1;  ///< of those pairs
  /// Whether forces are summed at all load sizes and not at the full load alone: for the bench,
  /// counted as "references" too.
  bool all_residuals = false;
};

/// How the body was made and how far it is from the fields of the series, stress from those of the
/// series' displacements.
struct IntrusiveReport {
  int greedy_modes = 0, alternations = 0;  ///< of the PGD, before it was recompressed
  int modes = 0, columns = 0;  ///< of displacement: F_i, and products F_i G(s) G(a) in the file
  int stress_modes = 0, stress_columns = 0;
  SeriesErrors displacement;                   ///< over the volume, products in the file included
  double stress_pooled = 0, stress_worst = 0;  ///< over the skin; a position and load size at worst
  /// ms of one core: pose, series (stress of all states included), separate, several loads; and
  /// "references", which the bake itself does not need.
  StageTimes cpu;
  /// (key, value) What of that is for people: loads, series, reduction, displacement, stress and
  /// perhaps several loads. In the body's provenance, too.
  std::vector<std::pair<std::string, std::string>> lines = {};
};

/// A body in the modes of its energy, under two loads, against a fresh Newton solve.
struct TwoLoadCheck {
  double deflection = 0;  ///< m, the largest of all nodes
  double error = 0;       ///< relative L2 over the volume, own norm
  int steps = 0;          ///< of the reduced Newton
  double ms = 0;          ///< CPU
};

/// All of it, for who asks on.
struct IntrusiveBake {
  TravellingLoad travelling;
  LoadSeries series;
  SeriesTable table;
  SeriesPgd pgd;  ///< the modes in the body, on all nodes
  ReducedBody body;
  IntrusiveReport report;
  Eigen::MatrixXd energy_modes;         ///< (3N x n) those of body.several on all nodes; or none
  std::vector<TwoLoadCheck> two_loads;  ///< what body.several's error is of
};

/// Series of all positions, their PGD in own norms with a fifth more modes than asked for,
/// recompressed; stress at the skin by a randomised POD of the stress at thirds of the load.
/// @throws Error as travelling_load(), LoadSeries and solve_series()
[[nodiscard]] IntrusiveBake bake_intrusive(const BodyDescription& description,
                                           const IntrusiveSettings& settings,
                                           const Progress& progress = {});

}  // namespace palpable
