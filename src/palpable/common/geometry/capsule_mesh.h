/// @file
/// A triangle mesh of a capsule for drawing, m, in the frame in which the capsule is given.
#pragma once

#include "palpable/common/geometry/capsule.h"

#include <Eigen/Core>

namespace palpable {

/// All vertices lie on the surface of the capsule, and all triangles at most a chord error inside
/// it. The vertices form rings round the axis; the first and the last vertex of a ring coincide and
/// have the angles 0 and 2 pi.
struct CapsuleMesh {
  Eigen::Matrix3Xd vertices;   ///< (3 x N) m
  Eigen::Matrix3Xd normals;    ///< (3 x N) unit, outwards
  Eigen::Matrix2Xd where;      ///< (2 x N) m along the surface from the pole at a; rad round it
  Eigen::Matrix3Xi triangles;  ///< (3 x M) counter-clockwise seen from outside
};

/// Meshes a capsule. Capsules with equal radii and length get equal triangles in every pose.
/// @param side         direction of the angle 0 round the axis; need not be perpendicular to it
/// @param chord_error  m, > 0, largest depth of a triangle inside the capsule
/// @throws ContractViolation unless radii and chord error are positive
[[nodiscard]] CapsuleMesh tessellate(const Capsule& capsule, const Eigen::Vector3d& side,
                                     double chord_error);

}  // namespace palpable
