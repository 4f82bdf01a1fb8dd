/// @file
/// The passes over the elements that a solve spends its time in, eight elements at a time.
///
///   A  nodes of an element      Q  its integration points      N  nodes of the body
///
/// Fields are (3 x N), column by column: x0 y0 z0 x1 ...
#pragma once

#include "palpable/solid/material.h"
#include "palpable/solid/simd.h"
#include "palpable/solid/tensor.h"

#include <span>

namespace palpable {

/// Eight elements of one kind and one material. Where the body has fewer left, the last one is
/// repeated with weights of zero.
template <int A, int Q>
struct alignas(kPackAlignment) ElementBlock {
  struct alignas(kPackAlignment) Point {
    Pack g[A][3];  ///< dN_a/dX, 1/m
    Pack weight;   ///< m^3
  };
  Point points[Q];
  int nodes[A][kPackSize];
};

/// What one pass over the forces finds.
struct ForceSums {
  double energy = 0;                 ///< J
  double smallest_volume_ratio = 0;  ///< min J over the points
  int most_compressed = -1;          ///< 8 block + lane of the element it belongs to
  bool inverted = false;             ///< some J is not above zero: forces and energy mean nothing
};

/// Adds dPsi/du of the blocks to `force`.
/// @param u, force  (3 x N)
template <int A, int Q>
ForceSums add_forces(SimdLevel level, const Material& material,
                     std::span<const ElementBlock<A, Q>> blocks, const double* u, double* force);

/// Adds the derivative of the forces at u along du to `change`: the tangent's product, without the
/// tangent. @pre no element is inverted under u
template <int A, int Q>
void add_force_changes(SimdLevel level, const Material& material,
                       std::span<const ElementBlock<A, Q>> blocks, const double* u,
                       const double* du, double* change);

/// d f_ai / d u_bk of eight elements at [a][b][i + 3 k], for a <= b; the rest is symmetric and 0.
template <int A>
struct alignas(kPackAlignment) ElementTangents {
  Pack K[A][A][9];
};

/// d force / du of one block. @pre no element is inverted under u
template <int A, int Q>
void element_tangents(SimdLevel level, const Material& material, const ElementBlock<A, Q>& block,
                      const double* u, ElementTangents<A>& tangents);

}  // namespace palpable
