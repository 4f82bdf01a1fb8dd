/// @file
/// The stress at the top of the colour scale.
#pragma once

#include "palpable/common/reduced/reduced_body.h"
#include "palpable/live/session/session.h"

namespace palpable {

/// The top (Pa) for a body that is pressed at one site: the 99th percentile of the vertices' von
/// Mises stress under the site's full load, and at least 1. The maximum occurs at a few vertices at
/// the rim of the support or of the patch; with that as the top, the rest of the body would have
/// the lowest colours only.
[[nodiscard]] double stress_scale_of_site(const ReducedBody& body, int site);

/// The top (Pa) for a body that is pressed anywhere: the 75th percentile over its sites.
[[nodiscard]] double stress_scale(const ReducedBody& body);

/// The top (Pa) for all bodies of a session, which share a legend: the largest of their tops.
[[nodiscard]] double stress_scale(const Session& session);

}  // namespace palpable
