/// @file
/// The order in which loops visit the elements.
#pragma once

#include <Eigen/Core>

#include <vector>

namespace palpable {

/// Points along Morton's curve through their bounding box ("A computer oriented geodetic data base
/// and a new technique in file sequencing", IBM, 1966). Consecutive points lie close together, so
/// their elements share nodes, which are still in the cache.
///
/// @param points  (3 x n), any unit
/// @return  (n) indices into points; the same every time, equal points in their own order
[[nodiscard]] std::vector<int> order_along_curve(const Eigen::Matrix3Xd& points);

}  // namespace palpable
