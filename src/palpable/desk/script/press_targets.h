/// @file
/// The places of a body that presses can aim at, its sites and the middles between them; and how
/// the body is turned so that the camera sees many of them.
#pragma once

#include "palpable/desk/script/press_search.h"

#include <cstddef>
#include <vector>

namespace palpable {

/// The body turned about the desk's Z axis.
[[nodiscard]] Rigid3 turned_body(double yaw);

/// One target for each site, in the order of the sites; desk frame.
[[nodiscard]] std::vector<PressTarget> site_targets(const DeskBody& body,
                                                    const Rigid3& desk_from_body);

/// Targets half way between neighbouring sites, pressed along the mean of the two directions; desk
/// frame. A site is paired with the nearest of the sites that follow it in the list. Pairs less
/// than 15 mm or more than 60 mm apart are left out, as are middles within 6 mm of a site and pairs
/// that are pressed against each other.
[[nodiscard]] std::vector<PressTarget> between_targets(const DeskBody& body,
                                                       const Rigid3& desk_from_body);

/// Targets on the skin, at every vertex or so many of them; pressed against the normal, leaning
/// towards the right, from where the hand comes. Desk frame.
/// @param most  number of targets
/// @param lean  by how much of the way to the right: 0 presses against the normal
[[nodiscard]] std::vector<PressTarget> skin_targets(const DeskBody& body,
                                                    const Rigid3& desk_from_body, int most,
                                                    double lean);

/// The world in a mirror at the plane X = 0, where a left hand is a right one.
[[nodiscard]] PressSearch mirror_image(const PressSearch& search);
[[nodiscard]] SurfacePoints mirror_image(const SurfacePoints& surface);
[[nodiscard]] std::vector<PressTarget> mirror_image(std::vector<PressTarget> targets);

/// Angles to turn the body by, rad, best first; of 36, 10 degrees apart, those at which some site
/// can be pressed by the rules. Better are angles at which the best sites have high scores.
/// @param sites      how many of the best sites' scores are added up
/// @param two_hands  the mirrored hand must find sites too: the smaller of both sums counts
[[nodiscard]] std::vector<double> yaws_to_press(const DeskBody& body, const PressRules& rules,
                                                std::size_t sites, bool two_hands);

}  // namespace palpable
