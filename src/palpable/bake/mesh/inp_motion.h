/// @file
/// Where an *INSTANCE of an input deck puts its part.
#pragma once

#include <Eigen/Geometry>

#include <optional>
#include <string_view>
#include <vector>

namespace palpable::inp {

/// The motion of an instance by its lines of data:
///
///     t1, t2, t3                        x + t
///     a1, a2, a3, b1, b2, b3, degrees   turned about the axis from a to b, after that
///
/// Nothing if they are not one line of 3 finite numbers and perhaps one of 7 with a not at b.
[[nodiscard]] std::optional<Eigen::Isometry3d> instance_motion(
    const std::vector<std::string_view>& lines);

}  // namespace palpable::inp
