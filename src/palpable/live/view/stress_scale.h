/// @file
/// Where the colours of stress end.
#pragma once

#include "palpable/common/reduced/reduced_body.h"
#include "palpable/live/session/session.h"

namespace palpable {

/// Pa at the top of the colour scale when one site is pressed: what 99 % of the vertices stay below
/// under its full load, at least 1. The largest of all stands at a few vertices at the rim of the
/// support or of the patch; a scale up to there leaves the rest of the body in its lowest colours.
[[nodiscard]] double stress_scale_of_site(const ReducedBody& body, int site);

/// The same for a body that is pressed anywhere: that of a site that is stiffer than three quarters
/// of the others.
[[nodiscard]] double stress_scale(const ReducedBody& body);

/// One for all bodies of a session, which share a legend: the largest of theirs.
[[nodiscard]] double stress_scale(const Session& session);

}  // namespace palpable
