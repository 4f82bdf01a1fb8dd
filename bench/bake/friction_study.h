/// @file
/// The effect of friction: things press and drag a body, solved in full order with and
/// without friction.
#pragma once

#include "palpable/bake/solid/contact.h"
#include "palpable/bake/touch_bake/skin_response.h"
#include "palpable/bake/touch_bake/touch_scenes.h"
#include "palpable/common/response/stated_error.h"

#include <functional>
#include <optional>
#include <string>

namespace palpable {

/// Difference of the solution without friction from the one with friction, at one moment.
struct FrictionDifference {
  PressingThing thing = PressingThing::kFinger;
  double depth = 0;         ///< m, motion of the thing since its first contact
  double dragged = 0;       ///< m, motion aside after that
  double displacement = 0;  ///< relative L2 over the skin's vertices
  double worst_vertex = 0;  ///< m
  double force = 0;         ///< of the resultant, relative
  double angle = 0;         ///< rad, between the two resultants
  double von_mises = 0;     ///< error of the worst vertex / largest stress on the skin
  /// Change of the solution with friction if all steps are halved: relative L2 over the skin's
  /// vertices.
  double half_step = 0;
};

/// Presses a scene to 2.5 and 5 mm, then drags it by 2.5 and 5 mm perpendicular to its path, and
/// compares the solutions at each of the four moments.
/// @param coefficient  Coulomb's, > 0
/// @param found        called at each moment
/// @returns why one of the solutions stopped before the end; empty if none did
[[nodiscard]] std::string compare_friction(
    const EquilibriumSolver& solver, const SkinResponse& skin, const Preloaded* preloaded,
    double point_spacing, const TouchScene& scene, double coefficient,
    const std::function<void(const FrictionDifference&)>& found);

/// Presses a scene to 5 mm in steps of 0.625 mm, and in half of these.
/// @param coefficient  Coulomb's; 0: none
/// @returns relative change of the displacement (L2 over the skin's vertices) with half the step;
///          nothing where a solution stopped before, or the obstacle presses skin that is held
[[nodiscard]] std::optional<double> change_of_press(const EquilibriumSolver& solver,
                                                    const SkinResponse& skin,
                                                    const Preloaded* preloaded,
                                                    double point_spacing, const TouchScene& scene,
                                                    double coefficient);

}  // namespace palpable
