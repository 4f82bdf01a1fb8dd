/// @file
/// A capsule as triangles, to be drawn. Metres; the frame is the capsule's.
#pragma once

#include "palpable/common/geometry/capsule.h"

#include <Eigen/Core>

namespace palpable {

/// All vertices lie on the surface of the capsule, all triangles inside it by at most a chord
/// error. The vertices form rings round the axis; the first and the last vertex of a ring coincide,
/// with the angles 0 and 2 pi.
struct CapsuleMesh {
  Eigen::Matrix3Xd vertices;   ///< (3 x N) m
  Eigen::Matrix3Xd normals;    ///< (3 x N) unit, outwards
  Eigen::Matrix2Xd where;      ///< (2 x N) m along the surface from the end of a; angle round it
  Eigen::Matrix3Xi triangles;  ///< (3 x M) counter-clockwise seen from outside
};

/// @param side         where round the axis the angle 0 is; need not be perpendicular to the axis
/// @param chord_error  m, > 0: no triangle lies deeper inside the capsule
/// Capsules with the same radii and length get the same triangles, wherever they are.
/// @throws ContractViolation unless radii and chord error are positive
[[nodiscard]] CapsuleMesh tessellate(const Capsule& capsule, const Eigen::Vector3d& side,
                                     double chord_error);

}  // namespace palpable
