/// @file
/// Sizes of bodies, and sizes as text for users.
#pragma once

#include <Eigen/Core>

#include <string>

namespace palpable {

/// m, the sides of the bounding box along the axes. @param points  (3 x N) m, N > 0
[[nodiscard]] Eigen::Vector3d extent_of(const Eigen::Matrix3Xd& points);

/// "80 x 76.1 x 68.1 mm": in m from 1 m on, else in mm.
/// @param size  m, extents of the bounding box
[[nodiscard]] std::string size_text(const Eigen::Vector3d& size);

/// "89.6 x 50.4 mm", likewise. @param size  m
[[nodiscard]] std::string size_text(const Eigen::Vector2d& size);

}  // namespace palpable
