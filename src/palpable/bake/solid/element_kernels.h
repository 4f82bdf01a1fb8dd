/// @file
/// Loops over the elements that evaluate energy, forces and tangents, eight elements at a time. A
/// solve spends most of its time here.
///
///   A  nodes of an element      Q  its integration points      N  nodes of the body
#pragma once

#include "palpable/bake/solid/node_rows.h"
#include "palpable/common/material/material.h"
#include "palpable/common/material/simd.h"
#include "palpable/common/material/tensor.h"

#include <span>

namespace palpable {

/// Eight elements of one kind and one material. The last block of a body is filled up with copies
/// of its last element whose weights are zero. The gradients of an element's nodes sum to zero, so
/// that of node 0 is not stored.
template <int A, int Q>
struct alignas(kPackAlignment) ElementBlock {
  struct alignas(kPackAlignment) Point {
    Pack g[A - 1][3];  ///< dN_a/dX of nodes 1 .. A - 1, 1/m
    Pack weight;       ///< m^3
  };
  Point points[Q];
  int nodes[A][kPackSize];
};

/// Sums and extremes over all integration points of one pass.
struct ForceSums {
  double energy = 0;                 ///< J
  double smallest_volume_ratio = 0;  ///< min J over the points
  int most_compressed = -1;          ///< 8 block + lane of the element it belongs to
  bool inverted = false;             ///< some J <= 0: forces and energy are meaningless
};

/// Adds the internal forces of the blocks, d(energy)/du at the displacements in `rows`, to
/// `forces`.
/// @param rows, forces  (N)
template <int A, int Q>
ForceSums add_forces(SimdLevel level, const Material& material,
                     std::span<const ElementBlock<A, Q>> blocks, const NodeRow* rows,
                     NodeSum* forces);

/// Adds the derivative of the forces at u along du to `changes`. This is the tangent times du,
/// computed without assembling the tangent. @pre no element is inverted under u
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
