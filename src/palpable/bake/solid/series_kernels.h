/// @file
/// Terms of the internal forces along a path, eight elements at a time: what the law's higher
/// derivatives add, for every law.
///
///     u(a) = u_0 + a u_1 + a^2 u_2,      P(F(a)) = P_0 + a P_1 + a^2 P_2 + a^3 P_3 + ...
///
///   A  nodes of an element      Q  its integration points      N  nodes of the body
#pragma once

#include "palpable/bake/solid/element_kernels.h"

namespace palpable {

/// Adds the coefficient of a^order, order 2 or 3, of the internal forces along u(a). For order 2
/// u_2 is taken as zero, so that what is added is 1/2 D^2 f (u_1, u_1); order 3 gives
/// D^2 f (u_1, u_2) + 1/6 D^3 f (u_1, u_1, u_1).
/// @param rows, sums  (N)
/// @pre no element is inverted under u_0
template <int A, int Q>
void add_force_term(SimdLevel level, const Material& material,
                    std::span<const ElementBlock<A, Q>> blocks, int order, const SeriesRow* rows,
                    NodeSum* sums);

}  // namespace palpable
