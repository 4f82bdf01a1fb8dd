/// @file
/// `bake --method intrusive-pgd`: a body under a load that travels, from its description to a body
/// file without a campaign (paper Sec. 5.1).
///
///   N  nodes   S  positions   J  load sizes
#pragma once

#include "palpable/bake/body_description.h"
#include "palpable/bake/series_pgd.h"
#include "palpable/bake/series_table.h"
#include "palpable/bake/travelling_load.h"
#include "palpable/base/progress.h"
#include "palpable/base/stage_clock.h"
#include "palpable/reduced/quartic_energy.h"
#include "palpable/reduced/reduced_body.h"
#include "palpable/solid/load_series.h"

#include <string>

namespace palpable {

struct IntrusiveSettings {
  std::string version, command_line;  ///< for the provenance
};

/// How the body was made and how far it is from the fields of the series, stress from those of the
/// series' displacements.
struct IntrusiveReport {
  int modes = 0, columns = 0;  ///< of displacement: F_i, and products F_i G(s) G(a) in the file
  int stress_modes = 0, stress_columns = 0;
  SeriesErrors displacement;                   ///< over the volume, products in the file included
  double stress_pooled = 0, stress_worst = 0;  ///< over the skin; a position and load size at worst
  StageTimes
      cpu;  ///< ms of one core: pose, series (stress of all states included), separate, write
};

/// All of it, for who asks on.
struct IntrusiveBake {
  TravellingLoad travelling;
  LoadSeries series;
  SeriesTable table;
  SeriesPgd pgd;  ///< the modes in the body, on all nodes
  ReducedBody body;
  IntrusiveReport report;
  /// Several loads at once: modes on all nodes, and the energy in them. No columns: one at a time.
  Eigen::MatrixXd energy_modes;
  QuarticEnergy energy;
};

/// Series of all positions, their PGD in own norms with a fifth more modes than asked for,
/// recompressed; stress at the skin by a randomised POD of the stress at thirds of the load.
/// @throws Error as travelling_load(), LoadSeries and solve_series()
[[nodiscard]] IntrusiveBake bake_intrusive(const BodyDescription& description,
                                           const IntrusiveSettings& settings,
                                           const Progress& progress = {});

}  // namespace palpable
