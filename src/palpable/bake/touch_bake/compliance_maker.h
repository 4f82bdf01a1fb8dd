/// @file
/// Computes the compliance of every vertex of a skin as a table (response/compliance.h).
#pragma once

#include "palpable/bake/touch_bake/skin_response.h"
#include "palpable/common/base/progress.h"
#include "palpable/common/response/compliance.h"

namespace palpable {

struct ComplianceSettings {
  double spacing = 0.014;      ///< m: largest distance of a vertex from its cluster's middle
  int most = 160;              ///< clusters; a skin that would need more gets larger clusters
  double near_radius = 0.028;  ///< m: clusters whose middles are at most this apart are near
  int rank = 32;               ///< k, columns of P; a multiple of 16
  int threads = 1;
};

/// The basis P of a cluster holds the leading directions of the displacements that loads at far
/// vertices, spread over the skin, cause in the cluster; each displacement field is divided by its
/// norm first. The basis for terms of higher order is made from displacements of the first and
/// second order. The other numbers of the table come from the solution for a unit load at every
/// component of every vertex: 3V solves, 5 ms each on a body of 16,000 nodes. An inner node of the
/// shell belongs to the cluster of the nearest vertex that is not held.
[[nodiscard]] ComplianceTable make_compliance(const SkinResponse& skin,
                                              const ComplianceSettings& settings,
                                              const Progress& progress = {});

/// The same table before any solve: clusters, neighbours and the size of everything are final, and
/// every number is 0. It tells how large the table will be.
[[nodiscard]] ComplianceTable compliance_without_numbers(const SkinResponse& skin,
                                                         const ComplianceSettings& settings);

/// Number of solves of the bases: unit loads at vertices spread over the skin, then patches of
/// pressure, which take two solves each.
/// @param vertices  that are not held
[[nodiscard]] int solves_of_bases(int vertices);

}  // namespace palpable
