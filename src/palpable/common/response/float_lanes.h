/// @file
/// The laws of hyperelasticity at eight points of a skin at a time, in single precision: a stress
/// of 60 kPa is off by some 0.01 Pa. For files that are compiled without contraction of a * b + c
/// (CMakeLists.txt), so that all processors give the same bytes.
#pragma once

#include "palpable/common/material/law.h"
#include "palpable/common/material/simd.h"
#include "palpable/common/material/tensor.h"

#include <cstdint>

namespace palpable {

/// Ratio of an element's volume to that at rest; a smaller J is replaced by it. An element below it
/// is about to be turned inside out, and its stress would grow without bound.
inline constexpr float kLeastVolume = 0.01f;
/// Pa: stresses are clipped to this, so that their squares stay finite in single precision.
inline constexpr float kMostStress = 1e15f;

using FloatPack = float __attribute__((vector_size(kPackSize * sizeof(float))));
using IntPack = std::int32_t __attribute__((vector_size(kPackSize * sizeof(std::int32_t))));
using WordPack = std::uint32_t __attribute__((vector_size(kPackSize * sizeof(std::uint32_t))));

/// Eight floats with the arithmetic of one number, for the formulas of the laws, whose constants
/// are doubles.
struct Lanes {
  FloatPack v;
  PALPABLE_ALWAYS_INLINE Lanes& operator+=(const Lanes& b) {
    v += b.v;
    return *this;
  }
  PALPABLE_ALWAYS_INLINE Lanes& operator-=(double b) {
    v -= static_cast<float>(b);
    return *this;
  }
};
PALPABLE_ALWAYS_INLINE Lanes lanes(double x) { return {FloatPack{} + static_cast<float>(x)}; }
PALPABLE_ALWAYS_INLINE Lanes operator+(const Lanes& a, const Lanes& b) { return {a.v + b.v}; }
PALPABLE_ALWAYS_INLINE Lanes operator-(const Lanes& a, const Lanes& b) { return {a.v - b.v}; }
PALPABLE_ALWAYS_INLINE Lanes operator*(const Lanes& a, const Lanes& b) { return {a.v * b.v}; }
PALPABLE_ALWAYS_INLINE Lanes operator/(const Lanes& a, const Lanes& b) { return {a.v / b.v}; }
PALPABLE_ALWAYS_INLINE Lanes operator+(double a, const Lanes& b) { return lanes(a) + b; }
PALPABLE_ALWAYS_INLINE Lanes operator-(double a, const Lanes& b) { return lanes(a) - b; }
PALPABLE_ALWAYS_INLINE Lanes operator*(double a, const Lanes& b) { return lanes(a) * b; }
PALPABLE_ALWAYS_INLINE Lanes operator/(double a, const Lanes& b) { return lanes(a) / b; }
PALPABLE_ALWAYS_INLINE Lanes operator-(const Lanes& a, double b) { return a - lanes(b); }
PALPABLE_ALWAYS_INLINE Lanes operator*(const Lanes& a, double b) { return a * lanes(b); }

/// logarithm() and inverse_cube_root() as in tensor.h, to single precision: the neglected terms of
/// the series are below 3e-9 of its first term.
PALPABLE_ALWAYS_INLINE Lanes logarithm(const Lanes& x) {
  const WordPack bits = (WordPack)x.v;
  const IntPack e = ((IntPack)(bits + (0x3f800000U - 0x3f3504f3U)) >> 23) - 127;
  const FloatPack m = (FloatPack)(bits - ((WordPack)e << 23));
  const FloatPack s = (m - 1.0f) / (m + 1.0f);
  const FloatPack q = s * s;
  const FloatPack series = ((q * (1.0f / 9) + 1.0f / 7) * q + 1.0f / 5) * q + 1.0f / 3;
  return {__builtin_convertvector(e, FloatPack) * 0.69314718f + 2.0f * (s + s * q * series)};
}
PALPABLE_ALWAYS_INLINE Lanes inverse_cube_root(const Lanes& x) {
  const FloatPack start =
      1.41989e9f - __builtin_convertvector((IntPack)x.v, FloatPack) * (1.0f / 3);
  FloatPack r = (FloatPack) __builtin_convertvector(start, IntPack);
  for (int step = 0; step < 3; ++step) r = r * (4.0f - x.v * r * r * r) * (1.0f / 3);
  return {r};
}

/// As deformation() of law.h, with J replaced by kLeastVolume where it is smaller. Returns 1 / J.
PALPABLE_ALWAYS_INLINE Lanes bounded_deformation(const Tensor<Lanes>& F, Deformation<Lanes>& d) {
  d.F = F;
  const Tensor<Lanes> cofactor = cofactors(F);
  const Lanes J = F(0, 0) * cofactor(0, 0) + F(1, 0) * cofactor(1, 0) + F(2, 0) * cofactor(2, 0);
  d.J = {J.v > kLeastVolume ? J.v : FloatPack{} + kLeastVolume};  // also where J is NaN
  const Lanes shrunk = 1.0 / d.J;
  d.G = shrunk * cofactor;
  d.I1 = inner(F, F);
  return shrunk;
}

/// Compiles to one instruction where errno of mathematical functions is turned off
/// (CMakeLists.txt).
PALPABLE_ALWAYS_INLINE FloatPack square_root(const FloatPack& x) {
  FloatPack root;
  for (int k = 0; k < kPackSize; ++k) root[k] = __builtin_sqrtf(x[k]);
  return root;
}

/// Clips to +- kMostStress; NaN becomes kMostStress.
PALPABLE_ALWAYS_INLINE FloatPack bounded(FloatPack s) {
  s = s < kMostStress ? s : FloatPack{} + kMostStress;
  return s > -kMostStress ? s : FloatPack{} - kMostStress;
}

/// Components of a symmetric tensor in the order xx yy zz xy yz zx.
inline constexpr int kStressRow[6] = {0, 1, 2, 0, 1, 2}, kStressColumn[6] = {0, 1, 2, 1, 2, 0};

/// sigma = P F^T / J, finite for any F. @param shrunk  1 / J  @param s  Pa, xx yy zz xy yz zx
PALPABLE_ALWAYS_INLINE void push_forward(const Tensor<Lanes>& P, const Tensor<Lanes>& F,
                                         const Lanes& shrunk, FloatPack (&s)[6]) {
  for (int c = 0; c < 6; ++c) {
    const int i = kStressRow[c], j = kStressColumn[c];
    const Lanes sum = P(i, 0) * F(j, 0) + P(i, 1) * F(j, 1) + P(i, 2) * F(j, 2);
    s[c] = bounded((sum * shrunk).v);
  }
}

/// sigma = (P(F) + F S) F^T / J, finite for any F.
/// @param S  Pa, added to the second Piola stress; xx yy zz xy yz zx
/// @param s  Pa, likewise
template <class Law>
PALPABLE_ALWAYS_INLINE void cauchy_stress(const Law& law, const Tensor<Lanes>& F,
                                          const FloatPack (&S)[6], FloatPack (&s)[6]) {
  constexpr int kEntry[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
  Deformation<Lanes> d;
  const Lanes shrunk = bounded_deformation(F, d);
  Tensor<Lanes> P = first_piola(law, d);
  for (int J = 0; J < 3; ++J) {
    for (int i = 0; i < 3; ++i) {
      for (int K = 0; K < 3; ++K) P(i, J).v += F(i, K).v * S[kEntry[K][J]];
    }
  }
  push_forward(P, F, shrunk, s);
}

/// sigma = P(F) F^T / J, finite for any F. @param s  Pa, xx yy zz xy yz zx
template <class Law>
PALPABLE_ALWAYS_INLINE void cauchy_stress(const Law& law, const Tensor<Lanes>& F,
                                          FloatPack (&s)[6]) {
  Deformation<Lanes> d;
  const Lanes shrunk = bounded_deformation(F, d);
  push_forward(first_piola(law, d), F, shrunk, s);
}

// Conversion between vectors in rows of four floats and lanes of eight floats.

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
