/// @file
/// Points of a mesh in messages.
#pragma once

#include <Eigen/Core>

#include <string>

namespace palpable {

/// The distance that a message should tell apart within a mesh: 1e-4 of the diagonal of its box, in
/// the unit of `points`; 0 for no points, and where a coordinate is not finite.
[[nodiscard]] double told_apart(const Eigen::Matrix3Xd& points);

/// "(0.5, 1.25, 3)": with four significant digits, and more where those would not tell points apart
/// that lie `apart` from each other, as in a small mesh far from the origin.
[[nodiscard]] std::string place_text(const Eigen::Vector3d& point, double apart);

}  // namespace palpable
