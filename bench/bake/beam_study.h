/// @file
/// Accuracy of a beam baked by intrusive PGD: the checks of `bench beam`.
#pragma once

#include "palpable/bake/intrusive/intrusive_bake.h"

#include <vector>

namespace palpable {

/// Error of a PGD trained without half of the positions, relative to the series' fields at these.
struct HeldOutPositions {
  int modes = 0, trained_on = 0, held_out = 0;
  double global = 0;  ///< relative L2 over the held-out positions and load sizes, by area
  double worst = 0;   ///< of the worst field, relative to its own norm
};

/// Every second position of each row (equal Y) is held out, but never the ends of a row; the modal
/// coordinates there are interpolated along the row by cubic splines.
/// @param skin  the skin to whose vertices the sites of `travelling` refer
[[nodiscard]] HeldOutPositions held_out_positions(const LoadSeries& body,
                                                  const TravellingLoad& travelling,
                                                  const SeriesTable& table, int modes,
                                                  const Progress& progress = {});

/// The error of a linear model: largest | u(s, a) - a u_1(s) | / | u(s, a) |.
[[nodiscard]] double linear_model_error(const SeriesTable& table);

/// Error of the baked body, evaluated as in the live half, relative to a full-order solution.
struct NewtonCheck {
  int site = 0;
  double level = 0;
  double deflection = 0;    ///< m, largest on the skin
  double displacement = 0;  ///< relative L2 over the skin
  double stress = 0;        ///< relative L2 over the skin
};

/// @param seed  for the random sites and levels (0.05 .. 1)
[[nodiscard]] std::vector<NewtonCheck> newton_checks(const IntrusiveBake& made, int count,
                                                     unsigned seed, const Progress& progress = {});

/// Difference of two bodies on one skin that were made in different ways, under the same loads: at
/// every common site, at half and all of the smaller of the two full loads.
struct BodyDifference {
  int shared = 0;  ///< sites at the same vertex
  /// Relative L2 differences over the skin, relative to the field of `other`.
  double displacement_pooled = 0, displacement_median = 0, displacement_worst = 0;
  double stress_pooled = 0, stress_median = 0, stress_worst = 0;
};

/// @throws Error if the skins differ or there is no common site
[[nodiscard]] BodyDifference body_difference(const ReducedBody& body, const ReducedBody& other);

}  // namespace palpable
