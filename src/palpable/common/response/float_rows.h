/// @file
/// Conversion between vectors in rows of four floats and lanes of eight floats (float_lanes.h). For
/// files that are compiled without contraction of a * b + c.
#pragma once

#include "palpable/common/response/float_lanes.h"

namespace palpable {

using Four = float __attribute__((vector_size(4 * sizeof(float))));
/// A vector; the fourth number is 0.
struct alignas(16) FourRow {
  Four v;
};

/// Gathers the vectors of eight rows, by component.
PALPABLE_ALWAYS_INLINE void gather(const FourRow* rows, const int (&n)[kPackSize],
                                   FloatPack (&u)[3]) {
  FloatPack two[4];  // rows k and k + 4
  for (int k = 0; k < 4; ++k) {
    two[k] = __builtin_shufflevector(rows[n[k]].v, rows[n[k + 4]].v, 0, 1, 2, 3, 4, 5, 6, 7);
  }
  const FloatPack xy_01 = __builtin_shufflevector(two[0], two[1], 0, 8, 1, 9, 4, 12, 5, 13);
  const FloatPack xy_23 = __builtin_shufflevector(two[2], two[3], 0, 8, 1, 9, 4, 12, 5, 13);
  const FloatPack z_01 = __builtin_shufflevector(two[0], two[1], 2, 10, 3, 11, 6, 14, 7, 15);
  const FloatPack z_23 = __builtin_shufflevector(two[2], two[3], 2, 10, 3, 11, 6, 14, 7, 15);
  u[0] = __builtin_shufflevector(xy_01, xy_23, 0, 1, 8, 9, 4, 5, 12, 13);
  u[1] = __builtin_shufflevector(xy_01, xy_23, 2, 3, 10, 11, 6, 7, 14, 15);
  u[2] = __builtin_shufflevector(z_01, z_23, 0, 1, 8, 9, 4, 5, 12, 13);
}

/// Stores eight vectors, given by component, in eight consecutive rows.
PALPABLE_ALWAYS_INLINE void store_rows(const FloatPack (&u)[3], FourRow* to) {
  const FloatPack none{};
  // x y of rows 0 1 and 4 5, then of 2 3 and 6 7; z 0 likewise.
  const FloatPack xy_low = __builtin_shufflevector(u[0], u[1], 0, 8, 1, 9, 4, 12, 5, 13);
  const FloatPack xy_high = __builtin_shufflevector(u[0], u[1], 2, 10, 3, 11, 6, 14, 7, 15);
  const FloatPack z_low = __builtin_shufflevector(u[2], none, 0, 8, 1, 9, 4, 12, 5, 13);
  const FloatPack z_high = __builtin_shufflevector(u[2], none, 2, 10, 3, 11, 6, 14, 7, 15);
  const FloatPack pairs[4] = {__builtin_shufflevector(xy_low, z_low, 0, 1, 8, 9, 4, 5, 12, 13),
                              __builtin_shufflevector(xy_low, z_low, 2, 3, 10, 11, 6, 7, 14, 15),
                              __builtin_shufflevector(xy_high, z_high, 0, 1, 8, 9, 4, 5, 12, 13),
                              __builtin_shufflevector(xy_high, z_high, 2, 3, 10, 11, 6, 7, 14, 15)};
  for (int k = 0; k < 4; ++k) {  // rows k and k + 4
    to[k].v = __builtin_shufflevector(pairs[k], none, 0, 1, 2, 3);
    to[k + 4].v = __builtin_shufflevector(pairs[k], none, 4, 5, 6, 7);
  }
}

}  // namespace palpable
