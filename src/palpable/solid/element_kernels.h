/// @file
/// The passes over the elements that a solve spends its time in, eight elements at a time.
///
///   A  nodes of an element      Q  its integration points      N  nodes of the body
#pragma once

#include "palpable/solid/material.h"
#include "palpable/solid/node_rows.h"
#include "palpable/solid/simd.h"
#include "palpable/solid/tensor.h"

#include <span>

namespace palpable {

/// Eight elements of one kind and one material. Where the body has fewer left, the last one is
/// repeated with weights of zero. Gradients of all nodes of an element sum to zero, so the first's
/// is not stored.
template <int A, int Q>
struct alignas(kPackAlignment) ElementBlock {
  struct alignas(kPackAlignment) Point {
    Pack g[A - 1][3];  ///< dN_a/dX of nodes 1 .. A - 1, 1/m
    Pack weight;       ///< m^3
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

/// Adds dPsi/du of the blocks at the rows' u to `forces`.
/// @param rows, forces  (N)
template <int A, int Q>
ForceSums add_forces(SimdLevel level, const Material& material,
                     std::span<const ElementBlock<A, Q>> blocks, const NodeRow* rows,
                     NodeSum* forces);

/// Adds the derivative of the forces at u along du to `changes`: the tangent's product, without the
/// tangent. @pre no element is inverted under u
/// @param rows, changes  (N)
template <int A, int Q>
void add_force_changes(SimdLevel level, const Material& material,
                       std::span<const ElementBlock<A, Q>> blocks, const NodeRow* rows,
                       NodeSum* changes);

/// d f_ai / d u_bk of eight elements at [a][b][i + 3 k], for a <= b; the rest is symmetric and 0.
template <int A>
struct alignas(kPackAlignment) ElementTangents {
  Pack K[A][A][9];
};

/// d force / du of one block. @pre no element is inverted under u
template <int A, int Q>
void element_tangents(SimdLevel level, const Material& material, const ElementBlock<A, Q>& block,
                      const NodeRow* rows, ElementTangents<A>& tangents);

}  // namespace palpable
