/// @file
/// What a beam baked by intrusive PGD is worth: the checks of `bench beam`.
#pragma once

#include "palpable/bake/intrusive/intrusive_bake.h"

#include <vector>

namespace palpable {

/// The PGD with half of the positions left out, against the series' fields there.
struct HeldOutPositions {
  int modes = 0, trained_on = 0, held_out = 0;
  double global = 0;  ///< relative L2 over the positions left out and the load sizes, by area
  double worst = 0;   ///< of one, in its own norm
};

/// Every second position of each row (equal Y) is left out, those at a row's ends never; what the
/// modes count there is interpolated along the row, by cubic splines.
/// @param skin  the vertices that the sites of `travelling` mean
[[nodiscard]] HeldOutPositions held_out_positions(const LoadSeries& body,
                                                  const TravellingLoad& travelling,
                                                  const SeriesTable& table, int modes,
                                                  const Progress& progress = {});

/// The largest | u(s, a) - a u_1(s) | / | u(s, a) |: a linear body's error.
[[nodiscard]] double linear_model_error(const SeriesTable& table);

/// The body as the live half evaluates it, against a fresh Newton solve.
struct NewtonCheck {
  int site = 0;
  double level = 0;
  double deflection = 0;    ///< m, the largest of the skin
  double displacement = 0;  ///< relative L2 over the skin, own norm
  double stress = 0;        ///< likewise
};

/// @param seed  of the sites and levels (0.05 .. 1) that are drawn
[[nodiscard]] std::vector<NewtonCheck> newton_checks(const IntrusiveBake& made, int count,
                                                     unsigned seed, const Progress& progress = {});

/// Two bodies on one skin, made in different ways, under the same loads: at every site that both
/// have, at half and all of the smaller of the two full loads.
struct BodyDifference {
  int shared = 0;  ///< sites at the same vertex
  /// Relative L2 differences over the skin, in the norm of `other`'s field.
  double displacement_pooled = 0, displacement_median = 0, displacement_worst = 0;
  double stress_pooled = 0, stress_median = 0, stress_worst = 0;
};

/// @throws Error if the skins differ, or no site is shared
[[nodiscard]] BodyDifference body_difference(const ReducedBody& body, const ReducedBody& other);

}  // namespace palpable
