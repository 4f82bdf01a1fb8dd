/// @file
/// Computes the surface of a pressed body for drawing.
#pragma once

#include "palpable/common/reduced/reduced_body.h"

#include <Eigen/Core>

#include <span>

namespace palpable {

/// Positions, normals and stress of the surface at one parameter point. Works through blocks of
/// vertices, so that displacement and stress components stay in the first-level cache. Allocates
/// nothing. Normals differ from vertex_normals() by rounding.
///
/// @param rest       (3 x V) m: body.surface.vertices
/// @param mu         as body.displacement.evaluate(): site, level
/// @param vertices   (3 x V) m, overwritten
/// @param normals    (3 x V) unit, area-weighted, outwards; overwritten; zero at vertices of no
///                   triangle with area
/// @param von_mises  (V) Pa, overwritten
/// @param cauchy     (6V) Pa, xx yy zz xy yz zx of each vertex, overwritten; empty: not computed
/// @throws ContractViolation on sizes other than these, or for mu as evaluate()
void press_surface(const ReducedBody& body, const Eigen::Matrix3Xf& rest,
                   std::span<const double> mu, Eigen::Matrix3Xf& vertices,
                   Eigen::Matrix3Xf& normals, std::span<float> von_mises,
                   std::span<float> cauchy = {});

}  // namespace palpable
