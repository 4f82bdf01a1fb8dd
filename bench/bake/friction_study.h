/// @file
/// What friction changes: things press and drag a body, by the full solver with and without it.
#pragma once

#include "palpable/bake/solid/contact.h"
#include "palpable/bake/touch_bake/skin_response.h"
#include "palpable/bake/touch_bake/touch_scenes.h"
#include "palpable/common/response/held_out_touch.h"

#include <functional>
#include <string>

namespace palpable {

/// How far the answer without friction is from the one with it, at one moment.
struct FrictionDifference {
  PressingThing thing = PressingThing::kFinger;
  double depth = 0;         ///< m that the thing has gone on since it just touched
  double dragged = 0;       ///< m that it has gone aside after that
  double displacement = 0;  ///< relative L2 over the skin's vertices
  double worst_vertex = 0;  ///< m
  double force = 0;         ///< of the resultant, relative
  double angle = 0;         ///< rad between the two resultants
  double von_mises = 0;     ///< of the stress at the worst vertex, against the largest on the skin
};

/// Presses a scene to 2.5 and 5 mm, then drags it aside by 2.5 and 5 mm, square to its way, and
/// compares at each of the four.
/// @param coefficient  Coulomb's, > 0
/// @param found        is called at each
/// @returns why one of the two walks stopped before the end; empty if neither did
[[nodiscard]] std::string compare_friction(
    const EquilibriumSolver& solver, const SkinResponse& skin, const Preloaded* preloaded,
    double point_spacing, const TouchScene& scene, double coefficient,
    const std::function<void(const FrictionDifference&)>& found);

}  // namespace palpable
