/// @file
/// `bake --intrusive`: a body under a load that travels, from its description to a body
/// file without a campaign (paper Sec. 5.1).
///
///   N  nodes   S  positions   J  load sizes
#pragma once

#include "palpable/bake/describe/body_description.h"
#include "palpable/bake/intrusive/series_pgd.h"
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
  /// Number of pairs of loads that are also solved in full, so that the body file can state its
  /// error under several loads at once. Their time is the stage "references".
  int checks = 6;
  unsigned seed = 1;  ///< of those pairs
  /// Whether residual forces are computed at all load sizes, and not at the full load alone. For
  /// the bench; counted as "references", too.
  bool all_residuals = false;
};

/// How the body was made, and its error against the fields of the series (for stress: against the
/// stress of the series' displacements).
struct IntrusiveReport {
  int greedy_modes = 0, alternations = 0;  ///< of the PGD, before it was recompressed
  int modes = 0, columns = 0;  ///< of displacement: F_i, and products F_i G(s) G(a) in the file
  int stress_modes = 0, stress_columns = 0;
  SeriesErrors displacement;                   ///< over the volume, products in the file included
  double stress_pooled = 0, stress_worst = 0;  ///< over the skin; a position and load size at worst
  /// ms of one core: pose, series (stress of all states included), separate, several loads; and
  /// "references", which the bake itself does not need.
  StageTimes cpu;
  /// The report in words, a part of the body's provenance: loads, series, reduction, displacement,
  /// stress and, if there are reactions, several loads.
  Provenance provenance = {};
};

/// The body in the modes of its energy, under two loads, compared with a full-order solution.
struct TwoLoadCheck {
  double deflection = 0;  ///< m, the largest of all nodes, full-order
  double error = 0;       ///< relative L2 over the volume, own norm
  int steps = 0;          ///< of the reduced Newton's method
  double ms = 0;          ///< CPU
};

/// All results of a bake, for callers that need more than the body.
struct IntrusiveBake {
  TravellingLoad travelling;
  LoadSeries series;
  SeriesTable table;
  SeriesPgd pgd;  ///< the modes in the body, on all nodes
  ReducedBody body;
  IntrusiveReport report;
  Eigen::MatrixXd energy_modes;         ///< (3N x n) of body.several, on all nodes; else empty
  std::vector<TwoLoadCheck> two_loads;  ///< basis of the error that body.several states
};

/// Bakes a body: the power series of all positions; their PGD in own norms with a fifth more modes
/// than asked for, recompressed to that number; and the stress at the skin by a randomised POD of
/// the stress at thirds of the load.
/// @throws Error as travelling_load(), LoadSeries and solve_series()
[[nodiscard]] IntrusiveBake bake_intrusive(const BodyDescription& description,
                                           const IntrusiveSettings& settings,
                                           const Progress& progress = {});

}  // namespace palpable
