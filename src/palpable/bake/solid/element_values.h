/// @file
/// What the loops over the elements (element_kernels.cpp, series_kernels.cpp) share: a block's
/// nodal values, their gradients, and the forces of a stress. Internal to this module.
#pragma once

#include "palpable/bake/solid/element_kernels.h"
#include "palpable/common/material/law.h"

namespace palpable {

/// Values of nodes 1 .. A - 1 of a block, [a - 1][i]. Gathered values are differences to node 0's,
/// which suffice because the gradients of the shape functions sum to zero. Forces on all nodes of
/// an element sum to zero too.
template <int A>
struct NodeValues {
  Pack at[A - 1][3];
};

/// @tparam kField  a member of Row: a field of the nodes
template <auto kField, class Row, int A, int Q>
PALPABLE_ALWAYS_INLINE void gather_differences(const Row* rows, const ElementBlock<A, Q>& block,
                                               NodeValues<A>& values) {
  Pack first[3];
  gather<kField>(rows, block.nodes[0], first);
  for (int a = 1; a < A; ++a) {
    gather<kField>(rows, block.nodes[a], values.at[a - 1]);
    for (int i = 0; i < 3; ++i) values.at[a - 1][i] -= first[i];
  }
}

template <int A, int Q>
PALPABLE_ALWAYS_INLINE void add_scattered(const NodeValues<A>& values,
                                          const ElementBlock<A, Q>& block, NodeSum* sums) {
  Pack first[3]{};
  for (int a = 1; a < A; ++a) {
    for (int i = 0; i < 3; ++i) first[i] -= values.at[a - 1][i];
    add_scattered(values.at[a - 1], block.nodes[a], sums);
  }
  add_scattered(first, block.nodes[0], sums);
}

/// sum_a (u_a - u_0) (dN_a/dX)^T
template <int A, class Point>
PALPABLE_ALWAYS_INLINE Tensor<Pack> gradient(const NodeValues<A>& u, const Point& point) {
  Tensor<Pack> H;
  for (int J = 0; J < 3; ++J) {
    for (int i = 0; i < 3; ++i) {
      Pack sum = u.at[0][i] * point.g[0][J];
      for (int a = 1; a < A - 1; ++a) sum += u.at[a][i] * point.g[a][J];
      H(i, J) = sum;
    }
  }
  return H;
}

template <int A, class Point>
PALPABLE_ALWAYS_INLINE Deformation<Pack> deformation_at(const NodeValues<A>& u,
                                                        const Point& point) {
  Tensor<Pack> F = gradient(u, point);
  for (int i = 0; i < 3; ++i) F(i, i) += 1.0;
  return deformation(F);
}

/// values_a += P dN_a/dX
template <int A, class Point>
PALPABLE_ALWAYS_INLINE void add_divergence(const Tensor<Pack>& P, const Point& point,
                                           NodeValues<A>& values) {
  for (int a = 0; a < A - 1; ++a) {
    for (int i = 0; i < 3; ++i) {
      values.at[a][i] +=
          P(i, 0) * point.g[a][0] + P(i, 1) * point.g[a][1] + P(i, 2) * point.g[a][2];
    }
  }
}

}  // namespace palpable
