/// @file
/// Things that hands hold, as capsules: a pencil and a cup.
///
/// Lengths in m. Cup frame: origin in the middle of the bottom, Z up along the axis, handle along
/// X.
#pragma once

#include "palpable/common/geometry/rigid.h"
#include "palpable/desk/script/hand_path.h"

#include <vector>

namespace palpable {

/// A hand that holds a pencil as for writing. The tip is the centre of the lead's rounded end.
[[nodiscard]] HandTool hand_with_pencil();

/// A hand round an upright cup, with the thumb up and the fingers level. The tip is the point of
/// the cup's axis at kGripHeight above its bottom. The palm faces -Z of the wrist frame.
[[nodiscard]] HandTool hand_round_cup();

/// A hand over an upright cup: index finger and thumb hold it at two opposite points outside of its
/// rim, the other fingers are bent. The tip is the point of the cup's axis at kRimGripHeight above
/// its bottom, and the tool points down.
[[nodiscard]] HandTool hand_over_cup();

/// The cup in that hand, wrist from cup.
/// @param handle  rad, angle about the cup's axis from the direction in which the hand points to
///                the handle, counter-clockwise as seen from above. At the rim, the index finger is
///                at -34 degrees and the thumb at 146; the bent fingers are above it, at -90
[[nodiscard]] Rigid3 wrist_from_held_cup(double handle);

/// The rotation of that hand, desk from wrist, when the cup is upright and the hand points along a
/// level direction (unit, desk frame).
[[nodiscard]] Eigen::Quaterniond turn_over_cup(const Eigen::Vector3d& pointing);

inline constexpr double kCupRadius = 0.040;  ///< m, outside
inline constexpr double kCupHeight = 0.092;
inline constexpr double kCupWallRadius = 0.003;  ///< m, half of the wall's thickness
inline constexpr double kGripHeight = 0.058;
inline constexpr double kRimGripHeight = 0.082;

inline constexpr int kCupStaves = 120;
inline constexpr int kCupHandleParts = 7;

/// The capsules of the cup in the desk frame: kCupStaves upright capsules side by side, whose outer
/// surface is within 0.17 mm of the wall, then kCupHandleParts capsules of the handle.
[[nodiscard]] std::vector<HandCapsule> cup_capsules(const Rigid3& desk_from_cup);

}  // namespace palpable
