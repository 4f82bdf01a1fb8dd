/// @file
/// The places of a body that presses can aim at: its sites, and what lies between two of them.
#pragma once

#include "palpable/synth/press_search.h"

#include <vector>

namespace palpable {

/// The body turned about the desk's Z axis.
[[nodiscard]] Rigid3 turned_body(double yaw);

/// One for each site, in their order; desk frame.
[[nodiscard]] std::vector<PressTarget> site_targets(const DeskBody& body,
                                                    const Rigid3& desk_from_body);

/// The vertices half way between neighbouring sites, pressed along the mean of their directions.
/// Each pair once; none where the sites lie within 15 mm or more than 60 mm apart, or where the
/// middle lies within 6 mm of a site.
[[nodiscard]] std::vector<PressTarget> between_targets(const DeskBody& body,
                                                       const Rigid3& desk_from_body);

}  // namespace palpable
