/// @file
/// Obstacles and their motions, as a user writes them.
#pragma once

#include "palpable/bake/solid/obstacle.h"

#include <filesystem>
#include <span>
#include <string>

namespace palpable {

/// Reads the parts of an obstacle and their motions from t = 0 to t = 1. Lengths are metres in the
/// body frame, or have their unit ("8 mm" is written 8mm):
///
///     sphere 8mm at 0,0,0.16 to 0,0,0.14
///     capsule 1.2mm,4mm at 0,0,0.16 and 0,0,0.3 to 0,0,0.14     ends of two radii; the first moves
///     plane 0,0,-1 at 0,0,0.16 to 0,0,0.14                      its normal, out of the solid
///     cup.stl                                                   a closed surface; moves with the
///                                                               poses of pose_file
///
/// Without "to" a part does not move. The file of a surface is in metres.
/// @param pose_file  body_from_surface along the way: lines "time tx ty tz qx qy qz qw" (TUM); with
///                   one line it does not move. Empty: none of the texts may be a surface
/// @throws Error naming the text (or file and line) and the forms that are allowed
[[nodiscard]] ObstacleMotion read_obstacle_way(std::span<const std::string> texts,
                                               const std::filesystem::path& pose_file);

}  // namespace palpable
