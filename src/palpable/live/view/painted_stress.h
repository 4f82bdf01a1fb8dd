/// @file
/// What may be painted beside von Mises stress: pressure in the material or one of the six
/// components, and how hard things press the skin.
///
///   V  vertices
#pragma once

#include "palpable/common/reduced/reduced_body.h"
#include "palpable/live/session/session.h"
#include "palpable/live/view/scene_show.h"

#include <span>
#include <string>
#include <vector>

namespace palpable {

/// Whether a field is made of SceneBody::cauchy, and has two signs.
[[nodiscard]] bool needs_components(SceneShow::Field field);

/// What a scene needs to have for a field to be painted.
[[nodiscard]] SceneExtras extras_for(SceneShow::Field field);

/// Top of the colours of contact pressure, against that of von Mises stress: what hardly gives way
/// in volume bears two to three times its largest von Mises stress below a fingertip.
inline constexpr double kContactOfStress = 3;
inline constexpr const char* kContactPressure = "contact pressure";
/// Above the bar instead: sites know forces alone.
inline constexpr const char* kNoContactKnown = "no contact known";

/// Whether a body's file holds its stress; modes of other programs may come without (then all of it
/// is 0).
[[nodiscard]] bool knows_stress(const ReducedBody& body);
/// The same of a session's body: tables of touch always know it.
[[nodiscard]] bool knows_stress(const Session& session, int number);
/// Whether it is known how hard things press a session's body at each vertex: not at its sites.
[[nodiscard]] bool knows_contact(const Session& session, int number);

/// p = -(xx + yy + zz) / 3, or the component alone.
/// @param field   one that needs_components()
/// @param cauchy  (6V) Pa, as SceneBody::cauchy
/// @param value   (V) Pa, overwritten; keeps its memory
void painted_stress(SceneShow::Field field, SceneShow::Component component,
                    std::span<const float> cauchy, std::vector<float>& value);

/// Above the colour bar: "pressure" or "stress zz". Takes no memory of its own.
void name_painted_stress(SceneShow::Field field, SceneShow::Component component, std::string& name);

/// Above the bar instead, where no body knows its stress.
inline constexpr const char* kNoStressKnown = "no stress known";

/// What the stated error beside the bar of such a field is of: von Mises stress. Nothing states
/// that of a component.
inline constexpr const char* kErrorOfStress = "stress";

}  // namespace palpable
