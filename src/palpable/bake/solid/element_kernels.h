/// @file
/// Loops over the elements that evaluate energy, forces and tangents, eight elements at a time. A
/// solve spends most of its time here.
///
///   A  nodes of an element      Q  its integration points      N  nodes of the body
#pragma once

#include "palpable/common/material/material.h"
#include "palpable/common/material/simd.h"
#include "palpable/common/material/tensor.h"

#include <span>

namespace palpable {

// Nodal values in the layout that the loops over the elements read and write. All values of a node
// lie in one cache line: a 4-node element touches four lines and not a dozen, and shuffles turn
// eight elements' values into packs.
//
// The tangent's product on 173,839 tetrahedra (a dragon of 40,159 nodes), one core with AVX-512,
// takes 7 ms and more from (3 x N) fields in the mesh's order, 4.6 ms with elements and nodes in
// the order of element_order.h, and 3.2 ms with this layout as well.

/// Four doubles: half a Pack (tensor.h).
using Quad = double __attribute__((vector_size(4 * sizeof(double))));

/// Input of a pass for one node. The fourth numbers are zero.
struct alignas(kPackAlignment) NodeRow {
  Quad u;   ///< m
  Quad du;  ///< a direction, m
};

/// Output of a pass for one node: a force or its change, N. The fourth number is zero.
struct alignas(kPackAlignment / 2) NodeSum {
  Quad force;
};

/// Input of a pass for the terms of a power series (series_kernels.h). The fourth numbers are zero.
struct alignas(kPackAlignment) SeriesRow {
  Quad base;    ///< m, u_0
  Quad first;   ///< m, u_1
  Quad second;  ///< m, u_2
  Quad unused;
};

/// The first three numbers of a field of eight nodes, as three packs.
/// @tparam kField  a member of Row
template <auto kField, class Row>
PALPABLE_ALWAYS_INLINE void gather(const Row* rows, const int (&n)[kPackSize], Pack (&values)[3]) {
  Quad half[2][3];
  for (int h = 0; h < 2; ++h) {
    const Quad& a = rows[n[4 * h]].*kField;
    const Quad& b = rows[n[4 * h + 1]].*kField;
    const Quad& c = rows[n[4 * h + 2]].*kField;
    const Quad& d = rows[n[4 * h + 3]].*kField;
    const Quad xz_ab = __builtin_shufflevector(a, b, 0, 4, 2, 6);
    const Quad xz_cd = __builtin_shufflevector(c, d, 0, 4, 2, 6);
    const Quad y_ab = __builtin_shufflevector(a, b, 1, 5, 3, 7);
    const Quad y_cd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
    half[h][0] = __builtin_shufflevector(xz_ab, xz_cd, 0, 1, 4, 5);
    half[h][1] = __builtin_shufflevector(y_ab, y_cd, 0, 1, 4, 5);
    half[h][2] = __builtin_shufflevector(xz_ab, xz_cd, 2, 3, 6, 7);
  }
  for (int i = 0; i < 3; ++i) {
    values[i] = __builtin_shufflevector(half[0][i], half[1][i], 0, 1, 2, 3, 4, 5, 6, 7);
  }
}

/// Adds three packs to eight nodes, one after the other: two elements of a block may share a node.
PALPABLE_ALWAYS_INLINE void add_scattered(const Pack (&values)[3], const int (&n)[kPackSize],
                                          NodeSum* sums) {
  const auto add = [&](int first, const Quad& x, const Quad& y, const Quad& z) {
    const Quad none{};
    const Quad xy_02 = __builtin_shufflevector(x, y, 0, 4, 2, 6);
    const Quad xy_13 = __builtin_shufflevector(x, y, 1, 5, 3, 7);
    const Quad z_02 = __builtin_shufflevector(z, none, 0, 4, 2, 6);
    const Quad z_13 = __builtin_shufflevector(z, none, 1, 5, 3, 7);
    sums[n[first]].force += __builtin_shufflevector(xy_02, z_02, 0, 1, 4, 5);
    sums[n[first + 1]].force += __builtin_shufflevector(xy_13, z_13, 0, 1, 4, 5);
    sums[n[first + 2]].force += __builtin_shufflevector(xy_02, z_02, 2, 3, 6, 7);
    sums[n[first + 3]].force += __builtin_shufflevector(xy_13, z_13, 2, 3, 6, 7);
  };
  const auto [x, y, z] = values;
  add(0, __builtin_shufflevector(x, x, 0, 1, 2, 3), __builtin_shufflevector(y, y, 0, 1, 2, 3),
      __builtin_shufflevector(z, z, 0, 1, 2, 3));
  add(4, __builtin_shufflevector(x, x, 4, 5, 6, 7), __builtin_shufflevector(y, y, 4, 5, 6, 7),
      __builtin_shufflevector(z, z, 4, 5, 6, 7));
}

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
