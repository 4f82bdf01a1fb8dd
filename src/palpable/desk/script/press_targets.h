/// @file
/// Targets of presses on a body: its sites, points between them, and points of the skin; and
/// rotations of the body for which the camera sees many of them.
#pragma once

#include "palpable/desk/script/press_search.h"

#include <cstddef>
#include <vector>

namespace palpable {

/// The pose of a body that is rotated about the desk's Z axis. @param yaw  rad
[[nodiscard]] Rigid3 turned_body(double yaw);

/// One target for each site, in the order of the sites; desk frame.
[[nodiscard]] std::vector<PressTarget> site_targets(const DeskBody& body,
                                                    const Rigid3& desk_from_body);

/// Targets half way between neighbouring sites, pressed along the mean of the two directions; desk
/// frame. A site is paired with the nearest of the sites that follow it in the list. Pairs less
/// than 15 mm or more than 60 mm apart are left out, as are midpoints within 6 mm of a site and
/// pairs with nearly opposite directions.
[[nodiscard]] std::vector<PressTarget> between_targets(const DeskBody& body,
                                                       const Rigid3& desk_from_body);

/// Targets at vertices of the skin, evenly spaced in the list of vertices. The press direction is
/// the inward normal, tilted so that the hand comes from the right. Desk frame.
/// @param most  approximate largest number of targets
/// @param lean  tilt: the direction is that of lean * (-X) - normal, so 0 presses along the normal
[[nodiscard]] std::vector<PressTarget> skin_targets(const DeskBody& body,
                                                    const Rigid3& desk_from_body, int most,
                                                    double lean);

/// Mirrors the scene at the plane X = 0, so that a left hand can be planned as a right one.
[[nodiscard]] PressSearch mirror_image(const PressSearch& search);
[[nodiscard]] SurfacePoints mirror_image(const SurfacePoints& surface);
[[nodiscard]] std::vector<PressTarget> mirror_image(std::vector<PressTarget> targets);

/// Rotations of the body, rad, among 36 that are 10 degrees apart: those for which some site can be
/// pressed within the rules, sorted by the sum of the scores of the best sites, highest first.
/// @param sites      number of best sites whose scores are added
/// @param two_hands  whether the mirrored hand must find sites, too; the smaller of both sums
///                   counts
[[nodiscard]] std::vector<double> yaws_to_press(const DeskBody& body, const PressRules& rules,
                                                std::size_t sites, bool two_hands);

}  // namespace palpable
