/// @file
/// Fields that may be painted besides von Mises stress: the pressure in the material, one of the
/// six components of stress, and the contact pressure on the skin.
///
///   V  vertices
#pragma once

#include "palpable/common/reduced/reduced_body.h"
#include "palpable/live/session/session.h"
#include "palpable/live/view/scene_show.h"
#include "palpable/live/view/show_names.h"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace palpable {

/// Whether a field is computed from SceneBody::cauchy; such fields have two signs.
[[nodiscard]] bool needs_components(SceneShow::Field field);

/// The extras that a scene must have for a field to be painted.
[[nodiscard]] SceneExtras extras_for(SceneShow::Field field);

/// Ratio of the top of contact pressure's colours to that of von Mises stress. Below a fingertip,
/// in a nearly incompressible material, the pressure is two to three times the largest von Mises
/// stress.
inline constexpr double kContactOfStress = 3;
inline constexpr const char* kContactPressure = "contact pressure";
/// The legend's title where a body has no contact pressure: the law of sites gives forces only.
inline constexpr const char* kNoContactKnown = "no contact known";

/// Whether a body's file holds its stress. Modes of other programs may come without stress, which
/// is then 0 everywhere.
[[nodiscard]] bool knows_stress(const ReducedBody& body);
/// The same for a session's body; one with tables of touch always has stress.
[[nodiscard]] bool knows_stress(const Session& session, int number);
/// Whether a session's body has a contact pressure at each vertex, which takes tables of touch.
[[nodiscard]] bool knows_contact(const Session& session, int number);

/// The value of the option --paint with this name. @pre `name` is one of kPaints
[[nodiscard]] const NamedPaint& paint_named(const std::string& name);
/// @param paint          one of kPaints' names
/// @param knows_stress   whether the body in this file has stress
/// @param knows_contact  whether it has contact pressure, i.e. is not pressed at sites
/// @throws Error when the body does not have the quantity to be painted
void expect_paintable(const std::string& paint, bool knows_stress, bool knows_contact,
                      const std::filesystem::path& body);

/// Computes the pressure p = -(xx + yy + zz) / 3, or one component.
/// @param field   one that needs_components()
/// @param cauchy  (6V) Pa, as SceneBody::cauchy
/// @param value   (V) Pa, overwritten; keeps its memory
void painted_stress(SceneShow::Field field, SceneShow::Component component,
                    std::span<const float> cauchy, std::vector<float>& value);

/// Writes the legend's title, "pressure" or "stress zz", into `name`, which keeps its memory.
void name_painted_stress(SceneShow::Field field, SceneShow::Component component, std::string& name);

/// The legend's title where no body has stress.
inline constexpr const char* kNoStressKnown = "no stress known";

/// Names the quantity of the stated error in the legend of such a field: the error is that of von
/// Mises stress, since none is stated for components.
inline constexpr const char* kErrorOfStress = "stress";

}  // namespace palpable
